// Compares headings with the yaw rate of odometry, to find wrong time stamps.
#pragma once

#include <optional>

#include <Eigen/Core>
#include <boost/circular_buffer.hpp>

#include "common/time.h"

namespace bevloc {

/// A match says where the vehicle heads at the time of its frameset, and GNSS at the time of its
/// sample. If these time stamps are late by `offset`, the heading is that of `offset` earlier: it
/// lags by the yaw rate times `offset` behind the integrated yaw rate. A constant difference of the
/// two says nothing, so the monitor compares changes over kLag, where the yaw rate has changed:
///
///   change of (heading - integrated heading)
///       = bias of the yaw rate * kLag + scale error * change of heading - offset * change of rate,
///
/// and fits bias, scale error and offset by least squares. A straight road gives no evidence of
/// the offset. One bend determines the offset of matches to about 20 ms. All cameras share it; the
/// synchronizer (Synchrony) finds a single camera whose stamps differ from those of the others.
///
/// Allocates in the constructor only. One thread.
class StampMonitor {
 public:
  struct Estimate {
    Duration offset{0};  ///< positive if the stamps are later than the headings
    Duration sigma{0};
  };

  /// `tolerated` is the largest offset that is no fault.
  explicit StampMonitor(Duration tolerated) : tolerated_(tolerated) {}

  /// Adds the vehicle's yaw rate. Times must increase; after a gap the history begins anew.
  void add_rate(Time time, double yaw_rate_radps);

  /// Adds a heading in the map whose time stamp lies within the latest rates.
  void add_heading(Time time, double heading_rad);

  /// The estimate, or nothing before the vehicle has turned enough.
  const std::optional<Estimate>& estimate() const { return estimate_; }

  /// Returns to the state after construction. Does not allocate.
  void reset();

  /// Begins a new history after a gap in time or a jump of the stamps. An offset that contradicts
  /// stays known until later headings agree, because a gap does not set the clocks of the cameras
  /// right.
  void note_gap();

  /// Whether the offset is certainly larger than tolerated. The answer stays true until agrees()
  /// holds for what was added since the latest contradiction.
  bool contradicts() const { return contradicts_; }

  /// Whether the offset is certainly smaller than tolerated.
  bool agrees() const;

  /// The latest offset in milliseconds that was certain, while it contradicts; otherwise 0. Later
  /// estimates that are not certain do not change it.
  int contradicting_ms() const;

 private:
  static constexpr size_t kRates = 128;
  static constexpr Duration kGap = std::chrono::milliseconds(100);
  static constexpr Duration kLag = std::chrono::seconds(2);
  /// If headings are missing for longer than this, the ones before and after are not compared,
  /// because the errors of the yaw rate add up meanwhile.
  static constexpr Duration kLongestLag = 2 * kLag;
  /// A heading that follows the latest one sooner than this is not used. So the headings of one lag
  /// fit into `headings_`.
  static constexpr Duration kSpacing = std::chrono::milliseconds(32);
  static constexpr size_t kHeadings = kLag / kSpacing + 2;

  struct Rate {
    Time time;
    double yaw_rate_radps = 0.0;
    double heading_rad = 0.0;  ///< integrated, with an arbitrary start
  };
  struct Heading {
    Time time;
    double difference_rad = 0.0;  ///< matched minus integrated, unwrapped
    double integrated_rad = 0.0;
    double yaw_rate_radps = 0.0;
  };

  std::optional<Rate> rate_at(Time time) const;
  void fit(const Heading& before, const Heading& now);
  std::optional<Estimate> solve() const;
  void judge();

  Duration tolerated_;
  boost::circular_buffer<Rate> rates_{kRates};
  boost::circular_buffer<Heading> headings_{kHeadings};
  /// Sums of the least-squares fit with exponential forgetting.
  struct Sums {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double square = 0.0;
    double rows = 0.0;
  };
  Sums sums_;
  std::optional<Estimate> estimate_;
  bool contradicts_ = false;
  Duration wrong_offset_{0};  ///< the latest offset that was certainly larger than tolerated
};

}  // namespace bevloc
