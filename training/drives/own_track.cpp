#include "training/drives/own_track.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "common/health_state.h"
#include "firmware/recording/topics.h"

namespace bevloc::drives {
namespace {

using Pose = ReferenceTrajectory::Pose;

/// Half of the window that a pose is smoothed over.
constexpr Duration kHalfWindow = std::chrono::milliseconds(500);
/// The time from one smoothed pose to the next.
constexpr Duration kStep = std::chrono::milliseconds(50);
/// Solutions come every 10 ms; after a longer gap a new stretch begins.
constexpr Duration kLongestGap = std::chrono::milliseconds(100);

bool is_sure(const bevloc::recording::Solution& solution, const SureLimits& limits) {
  if (solution.state() != static_cast<uint32_t>(HealthState::kTracking)) return false;
  if (!solution.pose_known() || solution.covariance_size() != 9) return false;
  const double xx = solution.covariance(0);
  const double xy = solution.covariance(1);
  const double yy = solution.covariance(4);
  const double largest = 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy);
  return std::sqrt(largest) <= limits.position_sigma_m &&
         std::sqrt(solution.covariance(8)) <= limits.yaw_sigma_rad;
}

/// For each column of `values`, the value at 0 of the parabola over the times with the least
/// squared distances.
Eigen::Vector3d parabolas_at_zero(const Eigen::ArrayXd& times_s, const Eigen::MatrixX3d& values) {
  Eigen::MatrixXd powers(times_s.size(), 3);
  powers.col(0).setOnes();
  powers.col(1) = times_s.matrix();
  powers.col(2) = times_s.square().matrix();
  return powers.householderQr().solve(values).row(0);
}

Pose smoothed_at(Time time, std::span<const Pose> window) {
  const auto count = static_cast<Eigen::Index>(window.size());
  Eigen::ArrayXd times_s(count);
  Eigen::MatrixX3d values(count, 3);
  const Se2& origin = window[window.size() / 2].map_from_vehicle;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Se2& pose = window[static_cast<size_t>(i)].map_from_vehicle;
    times_s(i) = to_seconds(window[static_cast<size_t>(i)].time - time);
    values.row(i) << pose.x_m - origin.x_m, pose.y_m - origin.y_m,
        wrap_angle(pose.yaw_rad - origin.yaw_rad);
  }
  const Eigen::Vector3d offset = parabolas_at_zero(times_s, values);
  return {
      time,
      {origin.x_m + offset.x(), origin.y_m + offset.y(), wrap_angle(origin.yaw_rad + offset.z())}};
}

}  // namespace

std::vector<Pose> smoothed(const std::vector<Pose>& poses) {
  constexpr size_t kFewest = 5;
  if (poses.size() < kFewest) return poses;
  std::vector<Pose> result;
  const Time end = poses.back().time - kHalfWindow;
  for (Time time = poses.front().time + kHalfWindow; time <= end; time += kStep) {
    const auto first = std::ranges::lower_bound(poses, time - kHalfWindow, {}, &Pose::time);
    const auto last = std::ranges::upper_bound(poses, time + kHalfWindow, {}, &Pose::time);
    if (static_cast<size_t>(last - first) < kFewest) continue;
    result.push_back(smoothed_at(time, {first, last}));
  }
  return result;
}

Result<ReferenceTrajectory> own_track(evaluation::Recording& recording, const SureLimits& limits) {
  std::vector<Pose> track;
  std::vector<Pose> stretch;
  Time sure_since = Time::max();
  const auto finish_stretch = [&] {
    std::ranges::copy(smoothed(stretch), std::back_inserter(track));
    stretch.clear();
    sure_since = Time::max();
  };
  Time latest = Time::min();
  for (const evaluation::MessagePlace& place : recording.messages(firmware::kSolutionTopic)) {
    const auto solution = recording.read<bevloc::recording::Solution>(place);
    if (!solution) return tl::unexpected(solution.error());
    const Time time = recording.clock_time(place.log_time_ns);
    if (time <= latest) continue;
    const bool gap = latest != Time::min() && time - latest > kLongestGap;
    latest = time;
    const bool sure = is_sure(*solution, limits);
    if (gap || !sure) finish_stretch();
    if (!sure) continue;
    if (sure_since == Time::max()) sure_since = time;
    if (time - sure_since < limits.settle) continue;
    stretch.push_back({time, firmware::se2_of(solution->map_from_vehicle())});
  }
  finish_stretch();
  return ReferenceTrajectory(std::move(track));
}

}  // namespace bevloc::drives
