#include "can/vehicle/wheel_fusion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

namespace bevloc::can {
namespace {

int side_of(WheelPlace place) {
  switch (place) {
    case WheelPlace::kRearLeft:
    case WheelPlace::kFrontLeft:
      return 1;
    case WheelPlace::kRearRight:
    case WheelPlace::kFrontRight:
      return -1;
    case WheelPlace::kVehicle:
      return 0;
  }
  return 0;
}

bool is_front(WheelPlace place) {
  return place == WheelPlace::kFrontLeft || place == WheelPlace::kFrontRight;
}

/// The mean of what was added.
struct Mean {
  double sum = 0.0;
  int count = 0;

  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return sum / count; }
};

}  // namespace

void WheelFusion::add(WheelPlace place, double speed_mps) {
  assert(count_ < estimates_.size());
  const int side = side_of(place);
  double along_mps = speed_mps;
  if (is_front(place)) {
    // A front wheel rolls along its own path, so its speed has a part along and a part across the
    // vehicle.
    const double across_mps = wheelbase_m_ * yaw_rate_radps_;
    const double squared = speed_mps * speed_mps - across_mps * across_mps;
    along_mps = std::copysign(std::sqrt(std::max(0.0, squared)), speed_mps);
  }
  estimates_[count_++] = {along_mps + side * half_track_m_ * yaw_rate_radps_, side};
}

double WheelFusion::wheel_speed(WheelPlace place, double speed_mps) const {
  const double along_mps = speed_mps - side_of(place) * half_track_m_ * yaw_rate_radps_;
  if (!is_front(place)) return along_mps;
  return std::copysign(std::hypot(along_mps, wheelbase_m_ * yaw_rate_radps_), along_mps);
}

double WheelFusion::median() const {
  std::array<double, 5> sorted{};
  const std::span<double> known = std::span(sorted).first(std::min(count_, sorted.size()));
  for (size_t i = 0; i < known.size(); ++i) known[i] = estimates_[i].speed_mps;
  std::ranges::sort(known);
  const size_t middle = count_ / 2;
  return count_ % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
}

std::optional<RearSpeeds> WheelFusion::speeds() const {
  if (count_ == 0) return std::nullopt;
  const double center_mps = median();
  const double allowed_mps = kSlip_mps + kSlipShare * std::abs(center_mps);
  Mean left;
  Mean right;
  Mean all;
  for (size_t i = 0; i < count_; ++i) {
    const Estimate& estimate = estimates_[i];
    const bool slips = std::abs(estimate.speed_mps - center_mps) > allowed_mps;
    if (count_ >= 3 && slips) continue;
    all.add(estimate.speed_mps);
    if (estimate.side > 0) left.add(estimate.speed_mps);
    if (estimate.side < 0) right.add(estimate.speed_mps);
  }
  if (2 * all.count < static_cast<int>(count_)) return std::nullopt;
  const double difference_mps = half_track_m_ * yaw_rate_radps_;
  return RearSpeeds{.left_mps = (left.count > 0 ? left : all).value() - difference_mps,
                    .right_mps = (right.count > 0 ? right : all).value() + difference_mps,
                    .both_sides = left.count > 0 && right.count > 0};
}

}  // namespace bevloc::can
