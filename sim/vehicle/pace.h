// How a vehicle keeps to its planned drive: it may stand, reverse, and drive on.
#pragma once

#include <vector>

namespace bevloc::sim {

/// From which time on the vehicle has which share of the planned speed: at 1 it drives as planned,
/// at 0 it stands, and with a negative share it reverses.
struct PacePoint {
  double at_s = 0.0;
  double pace = 1.0;
};

/// The pace over the time of a drive: linear between the points, constant before the first and
/// after the last one. Immutable, and so thread-safe.
class Pace {
 public:
  /// As planned all the time.
  Pace() = default;
  /// The times of the points must increase.
  explicit Pace(std::vector<PacePoint> points);

  struct Moment {
    double planned_s = 0.0;  ///< time at which the planned drive is at this place
    double pace = 1.0;
    double change_per_s = 0.0;
  };
  /// At time 0 the planned time is 0. It becomes negative if the vehicle reverses from its start.
  Moment at(double time_s) const;

  /// The least planned time up to `until_s`, where the vehicle is farthest back. It is at most 0.
  double earliest_planned_s(double until_s) const;

 private:
  struct Piece {
    double from_s;
    Moment start;
  };
  std::vector<Piece> pieces_;  ///< the first one starts at time 0
};

}  // namespace bevloc::sim
