// The reference system of a simulated recording: RTK GNSS with an IMU, and its errors.
#pragma once

#include "pipeline/calibration/reference_trajectory.h"
#include "sim/vehicle/drive.h"

namespace bevloc::evaluation {

/// Poses of the whole drive at 50 Hz; its start has the time `drive_start`. Along each axis the
/// position has a slow error (1.5 cm, correlated over 20 s) and a fast one (1 cm, over 1 s); the
/// heading has 0.05 degrees of each, over 30 s and 1 s.
ReferenceTrajectory receive_reference(const sim::Drive& drive, uint64_t seed, Time drive_start);

}  // namespace bevloc::evaluation
