#include "evaluation/campaign/modes/mode_list.h"

#include <utility>

namespace bevloc::evaluation {

sim::Fault fault(sim::FaultKind kind, const sim::FaultAmounts& amounts) {
  return {.kind = kind, .amounts = amounts};
}

sim::Fault fault(sim::FaultKind kind, const sim::FaultAmounts& amounts, int camera,
                 std::optional<int> other) {
  return {.kind = kind, .camera = camera, .other_camera = other, .amounts = amounts};
}

MatchFault locked(double across_m) {
  return {.kind = MatchFaultKind::kLocked, .offset = {0.0, across_m, 0.0}};
}

ModeList::ModeList(Mode common) : common_(std::move(common)) {}

void ModeList::add(std::string_view name, std::string_view what, FaultLength length,
                   std::vector<sim::Fault> faults, std::vector<MatchFault> match_faults,
                   WhyMask named_by) {
  Mode& mode = modes_.emplace_back(common_);
  mode.name = name;
  mode.what = what;
  mode.length = length;
  mode.faults = std::move(faults);
  mode.match_faults = std::move(match_faults);
  mode.named_by = named_by;
}

void ModeList::add(std::string_view name, std::string_view what, FaultLength length,
                   const sim::Fault& what_fails, WhyMask named_by) {
  add(name, what, length, {what_fails}, {}, named_by);
}

void ModeList::add(std::string_view name, std::string_view what, FaultLength length,
                   const MatchFault& what_fails, WhyMask named_by) {
  add(name, what, length, {}, {what_fails}, named_by);
}

void ModeList::add(std::string_view name, std::string_view what, FaultLength length,
                   std::vector<sim::PacePoint> pace, std::vector<sim::Fault> faults) {
  add(name, what, length, std::move(faults), {}, WhyMask{});
  modes_.back().pace = std::move(pace);
}

std::vector<Mode> ModeList::all() && {
  return std::move(modes_);
}

}  // namespace bevloc::evaluation
