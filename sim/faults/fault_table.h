// The table of all kinds of faults: their names, inputs and amounts.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "sim/faults/fault.h"

namespace bevloc::sim {

/// The input of the appliance that a fault disturbs.
enum class FaultInput : uint8_t {
  kGnss,
  kOdometry,
  kCamera,
  kMap,  ///< the map or the world, which then differ; from the start, except for kMapCut
  kClock,
  kBus,
  kThread,  ///< not an input: a thread of the appliance hangs in a simulated device
};

struct AmountInfo {
  std::string_view key;
  double FaultAmounts::*member;
  double low;
  double high;
  std::optional<double> fallback{};  ///< empty if the amount is required
  bool whole = false;                ///< a whole number
};

struct FaultKindInfo {
  FaultKind kind;
  std::string_view name;
  FaultInput input;
  std::span<const AmountInfo> amounts;
};

/// All kinds, in the order of FaultKind.
std::span<const FaultKindInfo> fault_kinds();
const FaultKindInfo& info_of(FaultKind kind);

/// Whether the fault has a time. A fault without one is there from the start of the drive.
bool has_time(FaultKind kind);

/// A fault of this kind with the fallback amounts.
Fault make_fault(FaultKind kind, double from_s = 0.0,
                 double until_s = std::numeric_limits<double>::infinity());

}  // namespace bevloc::sim
