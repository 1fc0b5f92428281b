#include "evaluation/recording/track.h"

#include <algorithm>

namespace bevloc::evaluation {

std::optional<Se2> pose_at(const Track& track, Time time) {
  constexpr Duration kWidest = std::chrono::milliseconds(300);
  const auto after = std::ranges::lower_bound(track, time, {}, &TrackPoint::time);
  if (after == track.end()) return std::nullopt;
  if (after->time == time) return after->map_from_vehicle;
  if (after == track.begin()) return std::nullopt;
  const TrackPoint& before = *std::prev(after);
  const Duration gap = after->time - before.time;
  if (gap > kWidest) return std::nullopt;
  const double share = to_seconds(time - before.time) / to_seconds(gap);
  const Se2& a = before.map_from_vehicle;
  const Se2& b = after->map_from_vehicle;
  return Se2{a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m),
             wrap_angle(a.yaw_rad + share * wrap_angle(b.yaw_rad - a.yaw_rad))};
}

Result<Track> read_track(Recording& recording, std::string_view topic) {
  Track track;
  for (const MessagePlace& place : recording.messages(topic)) {
    const auto message = recording.read<foxglove::PoseInFrame>(place);
    if (!message) return tl::unexpected(message.error());
    track.push_back({recording.clock_time(place.log_time_ns), firmware::pose_of(*message)});
  }
  return track;
}

}  // namespace bevloc::evaluation
