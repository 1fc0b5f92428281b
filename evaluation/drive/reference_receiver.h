// The reference system of a simulated drive: RTK GNSS with an IMU, and its errors.
#pragma once

#include <cstdint>
#include <functional>

#include "pipeline/calibration/reference_trajectory.h"
#include "sim/vehicle/drive.h"

namespace bevloc::evaluation {

/// Poses of `duration_s` at 50 Hz; the first one has the time `drive_start`. `truth` gives the pose
/// of the vehicle when this time has passed since. Along each axis the position has a slow error
/// (1.5 cm, correlated over 20 s) and a fast one (1 cm, over 1 s); the heading has 0.05 degrees of
/// each, over 30 s and 1 s.
ReferenceTrajectory receive_reference(const std::function<Se2(double time_s)>& truth,
                                      double duration_s, uint64_t seed, Time drive_start);
/// The reference of a whole drive without suspensions.
ReferenceTrajectory receive_reference(const sim::Drive& drive, uint64_t seed, Time drive_start);

}  // namespace bevloc::evaluation
