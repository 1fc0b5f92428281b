// Messages between the stages, and the queues that carry them.
#pragma once

#include <cstdint>

#include "common/bounded_queue.h"
#include "common/cameras.h"
#include "common/se2.h"
#include "common/time.h"
#include "common/vehicle_samples.h"
#include "drivers/camera/frame.h"
#include "pipeline/solver/solver_result.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

/// Vision to estimation: the result of one frameset.
struct VisionReport {
  Time frame_time;  ///< time of the frameset
  /// The cameras whose image was used. Without a prior, these are all cameras in the frameset.
  CameraMask present;
  bool skipped = false;  ///< older framesets were skipped for this one
  /// Whether a pose was known at frame_time. If not, nothing was matched.
  bool had_prior = false;
  bool map_nearby = false;       ///< the map has elements around the prior
  CameraMask calibration_fault;  ///< cameras that are not where the calibration says
  bool unsynchronized = false;   ///< the cameras do not expose together (Synchrony)
  /// Whether the time stamps of most cameras have jumped (drivers::StampSteps).
  bool stamps_jumped = false;
  /// How often the time stamps of most cameras have jumped so far, there and back.
  uint64_t stamp_jumps = 0;
  bool network_fault = false;  ///< the network failed its check, so nothing was matched
  Se2 prior;                   ///< T0: map_from_vehicle at frame_time
  MatchResult match;
};

/// Estimation to vision: the predicted pose, and how far to search around it.
struct Prediction {
  TrackedPose pose;
  bool acquiring = true;  ///< whether to search the wide range (SearchRange::kAcquiring)
};

using FrameQueue = BoundedQueue<drivers::Frame>;
using VehicleQueue = BoundedQueue<VehicleSample>;
using PredictionQueue = BoundedQueue<Prediction>;
using VisionQueue = BoundedQueue<VisionReport>;

/// All queues between the stages of one appliance. Thread-safe.
struct StageQueues {
  /// The frames of two framesets. Older frames would be skipped anyway.
  static constexpr size_t kFrames = 2 * kCameraCount;

  FrameQueue frames{kFrames};
  /// The predictions are written every bus cycle and read at every frameset, which may be a second
  /// apart.
  PredictionQueue predictions{128};
  /// Samples and reports are read every bus cycle; these capacities last for many cycles.
  VehicleQueue samples{256};
  VisionQueue reports{16};

  /// Wakes every stage that waits for an entry.
  void close() {
    frames.close();
    predictions.close();
    samples.close();
    reports.close();
  }
};

}  // namespace bevloc::firmware
