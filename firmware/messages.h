// What the stages hand each other through their queues.
#pragma once

#include "common/time.h"
#include "drivers/camera/frame.h"
#include "drivers/frameset/bounded_queue.h"
#include "firmware/vehicle_sample.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/solver/solver.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

/// What one frameset says about the pose.
struct VisionReport {
  Time frame_time;
  CameraMask present;      ///< with a picture that could be read, if it was looked at
  bool skipped = false;    ///< framesets before this one, because this one was already there
  bool had_prior = false;  ///< without one nothing could be matched
  bool map_nearby = false;
  bool unsynchronized = false;  ///< the cameras do not expose together (Synchrony)
  Se2 prior;                    ///< T0, map_from_vehicle at frame_time
  Correction correction;
};

/// Estimator to vision: where the vehicle is about to be, and how far to search.
struct Prediction {
  TrackedPose pose;
  bool acquiring = true;
};

using VehicleQueue = drivers::BoundedQueue<VehicleSample>;
using VisionQueue = drivers::BoundedQueue<VisionReport>;
using PredictionQueue = drivers::BoundedQueue<Prediction>;
using FrameQueue = drivers::BoundedQueue<drivers::Frame>;

}  // namespace bevloc::firmware
