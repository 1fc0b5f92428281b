#include "evaluation/drive/fault_config.h"

#include <algorithm>
#include <cmath>

#include "common/cameras.h"
#include "sim/faults/fault_table.h"

namespace bevloc::evaluation {
namespace {

using sim::AmountInfo;
using sim::FaultInput;
using sim::FaultKind;
using sim::FaultKindInfo;

/// Accepts the names that `name_of` gives for the elements of `all`.
template <typename All, typename NameOf>
Wanted<std::string> one_of_names(const All& all, NameOf name_of) {
  std::vector<std::string> names;
  for (const auto& element : all) names.emplace_back(name_of(element));
  return one_of(std::move(names));
}

FaultKind read_kind(YamlMap& yaml) {
  const auto kinds = sim::fault_kinds();
  const std::string name = yaml.require<std::string>(
      "kind", one_of_names(kinds, [](const FaultKindInfo& info) { return info.name; }));
  const auto found = std::ranges::find(kinds, name, &FaultKindInfo::name);
  return found == kinds.end() ? kinds.front().kind : found->kind;
}

int read_camera(YamlMap& yaml, std::string_view key) {
  const std::string name = yaml.require<std::string>(
      key, one_of_names(kCameraNames, [](std::string_view camera) { return camera; }));
  const auto found = std::ranges::find(kCameraNames, name);
  return found == kCameraNames.end() ? 0 : static_cast<int>(found - kCameraNames.begin());
}

void read_cameras(YamlMap& yaml, sim::Fault& fault) {
  const bool of_camera = sim::info_of(fault.kind).input == FaultInput::kCamera;
  if (!of_camera && fault.kind != FaultKind::kHangCapture) return;
  if (fault.kind == FaultKind::kCameraSwapped) {
    fault.camera = read_camera(yaml, "camera");
    fault.other_camera = read_camera(yaml, "with");
    if (fault.camera == fault.other_camera) yaml.reject("with", "the same camera", "another one");
  } else if (yaml.has("camera")) {
    fault.camera = read_camera(yaml, "camera");
  }
}

double read_amount(YamlMap& yaml, const AmountInfo& amount) {
  const auto wanted = between(amount.low, amount.high);
  const double value = amount.fallback ? yaml.optional<double>(amount.key, *amount.fallback, wanted)
                                       : yaml.require<double>(amount.key, wanted);
  if (amount.whole && value != std::floor(value)) {
    yaml.reject(amount.key, fmt::format("{}", value), "a whole number");
  }
  return value;
}

}  // namespace

sim::Fault read_fault(YamlMap& yaml) {
  sim::Fault fault = sim::make_fault(read_kind(yaml));
  if (sim::has_time(fault.kind)) {
    fault.from_s = yaml.optional<double>("from_s", fault.from_s, at_least(0.0));
    fault.until_s = yaml.optional<double>("until_s", fault.until_s, at_least(0.0));
    if (fault.until_s < fault.from_s) yaml.reject("until_s", "less than from_s", "from_s or more");
  }
  read_cameras(yaml, fault);
  for (const AmountInfo& amount : sim::info_of(fault.kind).amounts) {
    fault.amounts.*amount.member = read_amount(yaml, amount);
  }
  return fault;
}

}  // namespace bevloc::evaluation
