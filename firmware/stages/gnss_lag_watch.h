// Watches whether GNSS says where the vehicle is now, or where it was some time ago.
#pragma once

#include <algorithm>
#include <optional>

#include "common/se2.h"
#include "common/time.h"
#include "common/vehicle_samples.h"
#include "pipeline/localization/stamp_monitor.h"

namespace bevloc::firmware {

/// If GNSS is late, it puts the vehicle too far back along the road. Matches often do not show
/// this. The heading of GNSS is then late as well, and bends show by how much. A straight road
/// gives no evidence. A course over ground gives none either, because it describes the motion of
/// the antenna, and the receiver filters it. Allocates in the constructor only. One thread.
class GnssLagWatch {
 public:
  /// A sample may be as old as one cycle of GNSS.
  static constexpr Duration kTolerated = std::chrono::milliseconds(100);
  /// Headings with a larger sigma are not used. Receivers with two antennas have a smaller one, and
  /// courses over ground have a larger one.
  static constexpr double kMostSigma_rad = radians(2.0);

  /// Adds the vehicle's yaw rate.
  void add_rate(Time time, double yaw_rate_radps);

  /// Adds a sample of GNSS.
  void add(const GnssSample& sample);

  /// Whether the heading is certainly older than its time stamp by more than kTolerated.
  bool contradicts() const { return lag_ms() > 0; }

  /// How much older the heading is than its time stamp; 0 while it is tolerated. It is also
  /// 0 if the heading seems newer, because then the yaw rate is late.
  int lag_ms() const { return std::max(monitor_.contradicting_ms(), 0); }

  /// Begins a new history after a gap in time. GNSS that is too old stays so.
  void note_gap();

  /// Forgets everything, because GNSS is excluded for another reason.
  void reset();

 private:
  struct Heading {
    Time time;
    double yaw_rad = 0.0;
  };

  StampMonitor monitor_{kTolerated};
  std::optional<Heading> waiting_;  ///< is newer than the latest yaw rate
};

}  // namespace bevloc::firmware
