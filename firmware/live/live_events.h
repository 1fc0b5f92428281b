// The events of the live page: JSON texts as server-sent events.
#pragma once

#include <deque>
#include <string>

#include "firmware/live/live_feed.h"
#include "firmware/live/picture.h"
#include "firmware/status/status_json.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/map/map_index.h"

namespace bevloc::firmware {

/// A place where the vehicle was.
struct TrailPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  bool valid = false;
  bool begins = false;  ///< there was no pose between this place and the one before
};

// These functions return the events that the page draws. docs/live.md names them. Their keys are
// for the page alone.

/// `sent` is the time of a clock of the machine that goes on at real time, also in a drive with
/// --fast and while the machine is suspended. Its zero is arbitrary.
std::string status_event(const Telemetry& telemetry, const ProcessUse& process, Duration age,
                         Duration sent);
/// Returns the event with the trail. Each point is [x, y, valid, begins], where valid and begins
/// are 0 or 1.
std::string trail_event(const std::deque<TrailPoint>& trail);
/// Returns the event with the map's lines around a place, in metres in the map frame.
std::string map_event(const MapIndex& map, const Eigen::Vector2d& centre_m, double reach_m);
/// Returns the event with the mask, the map's lines at the prior and at the corrected pose, and the
/// distributions. `sample` must have a mask.
std::string match_event(const MapIndex& map, const LiveSample& sample);
/// Returns the event with one camera image, and with the places of the map's lines in it at the
/// prior and at the corrected pose, each moved to the exposure of the image. `sample` must have an
/// image. The result is empty if the image is damaged.
std::string camera_event(const MapIndex& map, const Rig& rig, const LiveSample& sample,
                         PictureMaker& pictures);

/// Returns the perceived mask as text: one character for each 2 x 2 cells, row by row from the
/// front left. In the character '0' + v, the level of class c is (v >> 2 c) & 3. Level 0 is a
/// probability below 1/4, 1 below 1/2, 2 below 3/4, and 3 is a higher one.
std::string mask_text(std::span<const float> logits);

}  // namespace bevloc::firmware
