// What the doctor says about one thing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bevloc::command {

enum class Level : uint8_t { kOk, kWarning, kProblem };

/// One thing that was looked at. Only warnings and problems have `wanted` and `fix`.
struct Finding {
  Level level = Level::kOk;
  std::string part;    ///< "cpu", "can0"
  std::string found;   ///< what there is
  std::string wanted;  ///< what there should be
  std::string fix;     ///< a command to type
};

using Findings = std::vector<Finding>;

inline Finding ok(std::string part, std::string found) {
  return {Level::kOk, std::move(part), std::move(found), "", ""};
}

/// The worst level of all.
Level worst_of(const Findings& findings);

/// One line for each finding, and its fix in a second one.
std::string to_text(const Findings& findings);

/// {"worst": "warning", "findings": [{level, part, found, wanted, fix}, ...]}.
std::string to_json(const Findings& findings);

}  // namespace bevloc::command
