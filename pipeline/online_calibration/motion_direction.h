// Compares the heading of the matches with the direction in which the vehicle moves.
#pragma once

#include <optional>

#include <boost/circular_buffer.hpp>

#include "common/driven_step.h"

namespace bevloc {

/// The matched heading against the direction of motion.
struct HeadingTurn {
  double turn_rad = 0.0;  ///< counter-clockwise
  double variance = 0.0;  ///< rad^2
};

/// The rear axle moves where the vehicle points. If all cameras are turned together, the matched
/// heading is turned with them, while the matched positions still lie on the path. Over some metres
/// the positions show the direction of motion: the path that odometry measured is laid over the
/// matched positions, and its headings are compared with the matched ones.
///
/// One thread. Allocates in the constructor only.
class MotionDirection {
 public:
  /// Least length of a stretch of road that gives one comparison.
  static constexpr double kStretch_m = 60.0;

  /// `map_from_vehicle` is the matched pose at the end of the step, if the match is clear. `step`
  /// is what the vehicle drove since the previous call. A new stretch begins if that is not known,
  /// if the step does not begin where the previous one ended, or kLongestPause after the latest
  /// clear match. Returns a comparison at the end of a stretch.
  std::optional<HeadingTurn> add(const std::optional<Se2>& map_from_vehicle,
                                 const std::optional<DrivenStep>& step);

 private:
  static constexpr size_t kMostPoses = 512;
  /// A stretch goes on until it has as many clear matches.
  static constexpr size_t kLeastPoses = 20;
  /// Longest time without a clear match within a stretch. In a longer time, odometry turns away
  /// from the path, and this would look like a turn of all cameras.
  static constexpr Duration kLongestPause = std::chrono::seconds(5);

  struct Sample {
    Se2 matched;
    Se2 driven;  ///< motion by odometry since the beginning of the stretch
  };

  void begin();
  HeadingTurn turn() const;

  boost::circular_buffer<Sample> samples_{kMostPoses};
  Se2 driven_;  ///< motion since the beginning of the stretch
  double length_m_ = 0.0;
  std::optional<Time> driven_until_;
  std::optional<Time> sampled_;  ///< time of the latest sample of the stretch
};

}  // namespace bevloc
