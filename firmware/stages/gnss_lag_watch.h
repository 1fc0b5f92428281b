// Watches whether GNSS says where the vehicle is now, or where it was some time ago.
#pragma once

#include <optional>

#include "common/time.h"
#include "common/vehicle_samples.h"
#include "pipeline/localization/stamp_monitor.h"

namespace bevloc::firmware {

/// GNSS that lags puts the vehicle too far back along the road, and matches often cannot tell. Its
/// heading lags as well, and bends show by how much. A receiver without heading, or a straight
/// road, gives no evidence. Allocates in the constructor only. One thread.
class GnssLagWatch {
 public:
  /// A sample may be as old as one cycle of GNSS.
  static constexpr Duration kTolerated = std::chrono::milliseconds(100);

  /// Adds the vehicle's yaw rate.
  void add_rate(Time time, double yaw_rate_radps);

  /// Adds a sample of GNSS.
  void add(const GnssSample& sample);

  /// Whether the heading is certainly older than its time stamp, or newer, by more than kTolerated.
  bool contradicts() const { return monitor_.contradicts(); }

  /// How much older the heading is than its time stamp; 0 while it is tolerated.
  int lag_ms() const { return monitor_.contradicting_ms(); }

  /// Forgets everything, after a gap in time or because GNSS is excluded for another reason.
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
