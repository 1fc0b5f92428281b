#include "evaluation/campaign/modes/mode.h"

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>

namespace bevloc::evaluation {
namespace {

constexpr double kStartShare = 1.0 / 3.0;

}  // namespace

FaultTime Mode::time_in(double duration_s) const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const bool is_plain_drive =
      faults.empty() && match_faults.empty() && pace.empty() && suspended_s <= 0.0;
  if (is_plain_drive) return {kNever, kNever};
  const double from_s = length.from_start ? 0.0 : kStartShare * duration_s;
  return {from_s, length.seconds > 0.0 ? from_s + length.seconds : kNever};
}

bool Mode::fails() const {
  const auto is_failure = [](const sim::Fault& fault) {
    return fault.kind != sim::FaultKind::kGnssNoHeading;
  };
  return std::ranges::any_of(faults, is_failure) || !match_faults.empty() || suspended_s > 0.0;
}

Result<std::vector<const Mode*>> modes_named(const std::vector<std::string>& names, Level level) {
  std::vector<const Mode*> found;
  if (names.empty()) {
    for (const Mode& mode : all_modes()) {
      if (mode.is_on(level)) found.push_back(&mode);
    }
    return found;
  }
  for (const std::string& name : names) {
    const auto mode = std::ranges::find(all_modes(), name, &Mode::name);
    if (mode == all_modes().end()) {
      return fail("mode {}: found no such mode, wanted one of `bevloc campaign --list`", name);
    }
    if (!mode->is_on(level)) {
      return fail("mode {}: found a level that cannot run this mode, wanted {}", name,
                  level == Level::kStage ? "--level pictures" : "--level stage");
    }
    found.push_back(&*mode);
  }
  return found;
}

}  // namespace bevloc::evaluation
