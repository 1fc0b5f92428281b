// What `bevloc doctor` says about one thing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bevloc::command {

enum class Level : uint8_t { kOk, kWarning, kProblem };

/// The finding about one thing. Only warnings and problems have `wanted` and `fix`.
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

/// Returns the worst level of all findings.
Level worst_of(const Findings& findings);

/// Returns one line for each finding, and its fix in a second line.
std::string to_text(const Findings& findings);

/// Returns {"worst": "warning", "findings": [{level, part, found, wanted, fix}, ...]}.
std::string to_json(const Findings& findings);

}  // namespace bevloc::command
