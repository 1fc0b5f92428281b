// Poses over time, read between two neighbours.
#pragma once

#include <optional>
#include <vector>

#include "common/se2.h"
#include "common/time.h"
#include "evaluation/recording/recording.h"

namespace bevloc::evaluation {

struct TrackPoint {
  Time time;
  Se2 map_from_vehicle;
};

/// Poses in the order of time.
using Track = std::vector<TrackPoint>;

/// The pose at this time between two points that are at most 0.3 s apart; nothing elsewhere.
std::optional<Se2> pose_at(const Track& track, Time time);

/// The recorded poses of a topic with messages foxglove.PoseInFrame.
Result<Track> read_track(Recording& recording, std::string_view topic);

}  // namespace bevloc::evaluation
