#include "command/doctor/finding.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"

namespace bevloc::command {
namespace {

std::string_view name_of_level(Level level) {
  switch (level) {
    case Level::kOk:
      return "ok";
    case Level::kWarning:
      return "warning";
    case Level::kProblem:
      break;
  }
  return "problem";
}

}  // namespace

Level worst_of(const Findings& findings) {
  Level worst = Level::kOk;
  for (const Finding& finding : findings) worst = std::max(worst, finding.level);
  return worst;
}

std::string to_text(const Findings& findings) {
  size_t width = 0;
  for (const Finding& finding : findings) width = std::max(width, finding.part.size());
  std::string text;
  for (const Finding& finding : findings) {
    text += fmt::format("{:<8} {:<{}}  {}", name_of_level(finding.level), finding.part, width,
                        finding.found);
    if (!finding.wanted.empty()) text += fmt::format("; wanted {}", finding.wanted);
    text += '\n';
    if (!finding.fix.empty()) text += fmt::format("{:{}}fix: {}\n", "", width + 11, finding.fix);
  }
  const auto count = [&findings](Level level) {
    return std::ranges::count(findings, level, &Finding::level);
  };
  return text + fmt::format("{} checks: {} ok, {} warnings, {} problems\n", findings.size(),
                            count(Level::kOk), count(Level::kWarning), count(Level::kProblem));
}

std::string to_json(const Findings& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    nlohmann::ordered_json item = {
        {"level", name_of_level(finding.level)}, {"part", finding.part}, {"found", finding.found}};
    if (!finding.wanted.empty()) item["wanted"] = finding.wanted;
    if (!finding.fix.empty()) item["fix"] = finding.fix;
    list.push_back(std::move(item));
  }
  const nlohmann::ordered_json all = {{"worst", name_of_level(worst_of(findings))},
                                      {"findings", std::move(list)}};
  return json_document(all);
}

}  // namespace bevloc::command
