#include "pipeline/map/formats/class_table.h"

#include <algorithm>

#include "common/files.h"
#include "common/strict_yaml.h"
#include "pipeline/map/class_names.h"

namespace bevloc {
namespace {

bool rule_fits(std::string_view pattern, std::string_view kind) {
  if (!pattern.ends_with('*')) return pattern == kind;
  return kind.starts_with(pattern.substr(0, pattern.size() - 1));
}

ClassTable::Rule read_rule(YamlMap& yaml) {
  ClassTable::Rule rule;
  rule.kind = yaml.require<std::string>("kind");
  const auto becomes = yaml.require<std::string>("becomes");
  const auto look = yaml.optional<std::string>("appearance", "unknown");
  const auto element_class = class_named(becomes);
  const auto appearance = appearance_named(look);
  if (!element_class && becomes != "nothing") {
    yaml.reject("becomes", fmt::format("\"{}\"", becomes),
                "divider, crossing, boundary or nothing");
  } else if (!appearance || (element_class && !fits(*appearance, *element_class))) {
    yaml.reject("appearance", fmt::format("\"{}\"", look),
                fmt::format("an appearance of a {} (docs/maps.md)", becomes));
  } else if (element_class) {
    rule.becomes = Meaning{*element_class, *appearance};
  }
  return rule;
}

}  // namespace

Result<ClassTable> ClassTable::read_file(const std::filesystem::path& path) {
  return parse_file(path, parse);
}

Result<ClassTable> ClassTable::parse(const std::string& text, const std::string& name) {
  auto yaml = YamlMap::parse(text, name);
  if (!yaml) return tl::unexpected(yaml.error());
  ClassTable table;
  for (YamlMap& rule : yaml->require_map_list("rules")) {
    const size_t index = table.rules_.size();
    table.rules_.push_back(read_rule(rule));
    table.rules_.back().place = fmt::format("{}: rules[{}]", name, index);
  }
  if (Status status = yaml->finish(); !status) return tl::unexpected(status.error());
  return table;
}

const ClassTable::Rule* ClassTable::rule_for(std::string_view kind) const {
  const auto found =
      std::ranges::find_if(rules_, [kind](const Rule& rule) { return rule_fits(rule.kind, kind); });
  return found == rules_.end() ? nullptr : &*found;
}

Status check_rules(const ClassTable& classes, const ImportReport& report, const std::string& file) {
  const std::vector<ImportRow> rows = report.rows();
  for (const ClassTable::Rule& rule : classes.rules()) {
    const auto fits_row = [&](const ImportRow& row) { return classes.rule_for(row.kind) == &rule; };
    if (std::ranges::any_of(rows, fits_row)) {
      const bool is_possible = !rule.becomes || std::ranges::any_of(rows, [&](const auto& row) {
        return row.has_line && fits_row(row);
      });
      if (is_possible) continue;
      return fail(
          "{}: found a rule that makes lines of \"{}\", which has none in {}; give a rule for the "
          "ways of a relation",
          rule.place, rule.kind, file);
    }
    const bool is_hidden = std::ranges::any_of(
        rows, [&](const ImportRow& row) { return rule_fits(rule.kind, row.kind); });
    if (is_hidden) {
      return fail(
          "{}: an earlier rule already takes every kind that the rule for \"{}\" fits; move the "
          "rule for \"{}\" before it",
          rule.place, rule.kind, rule.kind);
    }
    return fail("{}: found a rule for \"{}\", wanted a kind that is in {} ({} kinds)", rule.place,
                rule.kind, file, rows.size());
  }
  return {};
}

}  // namespace bevloc
