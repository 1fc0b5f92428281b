// The recent inputs of the tracker, each with the filter state after it.
#pragma once

#include <cstddef>

#include <boost/circular_buffer.hpp>

#include "common/time.h"
#include "pipeline/tracker/motion_model.h"
#include "pipeline/tracker/pose_update.h"

namespace bevloc {

struct TrackerEvent {
  enum class Kind {
    kOdometry,  ///< `motion` is a sample
    kPose,      ///< `measurement` was accepted
    kWiden,     ///< the covariance of the pose was increased
    kLoosen,    ///< the covariance of the odometry errors and the yaw was increased
  };

  Time time;
  Kind kind = Kind::kOdometry;
  MeasuredMotion motion = {};        ///< motion at `time`, perhaps interpolated between samples
  PoseMeasurement measurement = {};  ///< used only if `kind` is kPose
  FilterState state = {};            ///< state after the event
};

/// Events, sorted by time. The buffer allocates in its constructor only.
using EventHistory = boost::circular_buffer<TrackerEvent>;

/// Number of events at or before `time`. Searches from the newest event, because nearly all callers
/// ask for a recent time.
inline size_t count_until(const EventHistory& history, Time time) {
  size_t count = history.size();
  while (count > 0 && history[count - 1].time > time) --count;
  return count;
}

}  // namespace bevloc
