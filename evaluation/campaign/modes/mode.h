// The failure modes of the campaign.
#pragma once

#include <string_view>
#include <vector>

#include "common/health_state.h"
#include "common/result.h"
#include "evaluation/campaign/modes/fault_time.h"
#include "evaluation/campaign/modes/match_fault.h"
#include "sim/faults/fault.h"
#include "sim/vehicle/pace.h"

namespace bevloc::evaluation {

/// Where a mode can be run (docs/integrity.md).
enum class Level : uint8_t {
  kStage,     ///< the estimation stage with the modelled matcher
  kPictures,  ///< the whole appliance on pictures
};

/// How long the fault of a mode lasts. It begins after a third of the drive, unless it is there
/// from the start.
struct FaultLength {
  double seconds = 0.0;  ///< 0: until the end of the drive
  bool from_start = false;
};

struct Mode {
  std::string_view name{};
  std::string_view what{};  ///< what goes wrong, for the table
  FaultLength length{};
  /// Their times are not used, because the campaign sets them.
  std::vector<sim::Fault> faults{};
  std::vector<MatchFault> match_faults{};  ///< on the stage level
  std::vector<sim::PacePoint> pace{};      ///< over the time since the fault begins
  double suspended_s = 0.0;                ///< the appliance sleeps this long; its clock goes on
  WhyMask named_by{};                      ///< the why bits that name the fault
  /// How long poses beyond the freeway alert limits may be valid, in the worst seed.
  double limit_s = 0.3;
  bool on_stage = true;
  bool on_pictures = true;

  /// Whether something fails. A vehicle that crawls, stands or reverses is no failure, nor is GNSS
  /// without a heading (G5 in docs/safety.md).
  bool fails() const;
  bool is_on(Level level) const { return level == Level::kStage ? on_stage : on_pictures; }
  FaultTime time_in(double duration_s) const;
};

/// All modes, in the order of the table.
const std::vector<Mode>& all_modes();

/// The modes with these names; all modes of the level without names. Fails for an unknown name, and
/// for a mode that the level does not have.
Result<std::vector<const Mode*>> modes_named(const std::vector<std::string>& names, Level level);

}  // namespace bevloc::evaluation
