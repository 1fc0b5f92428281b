// A user's own mapping of the kinds of a map file to bevloc's classes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "pipeline/map/formats/import_report.h"

namespace bevloc {

/// The table is read from a YAML file such as
///
///     rules:
///       - kind: road mark curb      # a kind as the report of an import shows it
///         becomes: boundary         # divider, crossing, boundary or nothing
///         appearance: kerb          # optional
///
/// A kind that ends in * stands for all kinds that begin so. The first rule that fits counts.
class ClassTable {
 public:
  struct Rule {
    std::string kind;
    std::optional<Meaning> becomes;  ///< nothing if lines of this kind are dropped
    std::string place{};             ///< "classes.yaml: rules[0]", for messages
  };

  ClassTable() = default;

  static Result<ClassTable> read_file(const std::filesystem::path& path);
  /// Does the same for a text in memory. Messages show `name` as the file.
  static Result<ClassTable> parse(const std::string& text, const std::string& name);

  /// Returns null if no rule fits.
  const Rule* rule_for(std::string_view kind) const;
  const std::vector<Rule>& rules() const { return rules_; }

 private:
  std::vector<Rule> rules_;
};

/// Fails, with the file of the table and the number of the rule, if a rule fits no kind of the
/// report, which is probably a typing mistake, or only kinds that an earlier rule takes.
Status check_rules(const ClassTable& classes, const ImportReport& report, const std::string& file);

}  // namespace bevloc
