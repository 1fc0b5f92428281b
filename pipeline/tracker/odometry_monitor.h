// Finds odometry samples that no vehicle can have measured.
#pragma once

#include <optional>

#include "common/vehicle_samples.h"

namespace bevloc {

/// Odometry may pass every check of the bus and still be wrong: a controller that repeats its last
/// values, or wheels that slip or lock. This class checks each sample against the ones before it.
/// Allocates nothing. One thread.
class OdometryMonitor {
 public:
  /// Adds a sample, in the order of time. Returns true if the filter may use it.
  bool accept(const OdometrySample& sample);

  /// Whether the latest sample was refused.
  bool implausible() const { return implausible_; }

  void reset() { *this = OdometryMonitor(); }

 private:
  bool is_stuck(const OdometrySample& sample);
  bool jumps(const OdometrySample& sample) const;
  bool turns_round(const OdometrySample& sample) const;

  std::optional<OdometrySample> latest_;    ///< the latest sample, refused or not
  std::optional<OdometrySample> accepted_;  ///< the reference for jumps
  int repetitions_ = 0;
  bool implausible_ = false;
};

}  // namespace bevloc
