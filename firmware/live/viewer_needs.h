// Whether a viewer of the live page lacks the trail or the map, and around where the map is sent.
#pragma once

#include <atomic>
#include <optional>

#include <Eigen/Core>

#include "firmware/telemetry/pose_snapshot.h"

namespace bevloc::firmware {

/// A viewer needs trail and map once, when it comes and when it has missed events. All viewers need
/// the map again after the vehicle has moved far. set() is thread-safe. The owner makes sure that
/// calls of the other functions do not overlap.
class ViewerNeeds {
 public:
  /// The map is sent again when the vehicle is this far from the place around which it was sent.
  static constexpr double kMapRenewal_m = 60.0;

  /// Notes that a viewer lacks trail and map. The viewer must have its place in the event queue
  /// before this call, so that it gets what is sent after it.
  void set() {
    trail_ = true;
    map_ = true;
  }

  /// Returns whether the trail must be sent, once.
  bool take_trail() { return trail_.exchange(false); }

  /// Returns the place around which the map must be sent, once: near the vehicle, in metres in the
  /// map frame. If no pose was known yet, the need stays.
  std::optional<Eigen::Vector2d> take_map(const PoseSnapshot& pose) {
    if (pose.known) {
      const Eigen::Vector2d place = pose.map_from_vehicle.translation();
      if (!centre_m_ || (place - *centre_m_).norm() > kMapRenewal_m) {
        centre_m_ = place;
        map_ = true;
      }
    }
    return centre_m_ && map_.exchange(false) ? centre_m_ : std::nullopt;
  }

  /// Forgets the place, because another map follows.
  void forget_place() { centre_m_.reset(); }

 private:
  std::atomic<bool> trail_{false};
  std::atomic<bool> map_{false};
  std::optional<Eigen::Vector2d> centre_m_;
};

}  // namespace bevloc::firmware
