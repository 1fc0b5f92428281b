// What the localizer tells the bus each cycle.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include <Eigen/Core>

#include "common/se2.h"
#include "common/time.h"

namespace bevloc::can {

/// Values of LOC_Status.State.
enum class LocalizerState : uint8_t {
  kInit = 0,
  kAcquiring = 1,
  kTracking = 2,
  kDegraded = 3,
  kLost = 4,
  kFault = 5,
};

/// Values of LOC_Status.TimeSource.
enum class TimeSource : uint8_t { kFreeRunning = 0, kPtp = 1, kGnss = 2 };

/// Bits that say why the state is not better than it is; the bit numbers of LOC_Status.Why_*.
enum class Why : uint16_t {
  kCameraMissing = 1u << 0,
  kCamerasUnsynchronized = 1u << 1,
  kOdometryMissing = 1u << 2,
  kGnssMissing = 1u << 3,
  kNoInitialPose = 1u << 4,
  kOutsideMap = 1u << 5,
  kMatchUncertain = 1u << 6,
  kMatchRejected = 1u << 7,
  kPoseUncertain = 1u << 8,
  kPoseStale = 1u << 9,
  kPoseInvalid = 1u << 10,
  kOverload = 1u << 11,
  kMapFault = 1u << 12,
  kCalibrationFault = 1u << 13,
  kNetworkFault = 1u << 14,
  kInternalFault = 1u << 15,
};

/// A set of Why bits.
class WhyMask {
 public:
  constexpr WhyMask() = default;
  constexpr WhyMask(Why why) : bits_(static_cast<uint16_t>(why)) {}
  static constexpr WhyMask from_bits(uint16_t bits) {
    WhyMask mask;
    mask.bits_ = bits;
    return mask;
  }
  constexpr WhyMask& operator|=(WhyMask other) {
    bits_ = static_cast<uint16_t>(bits_ | other.bits_);
    return *this;
  }
  friend constexpr WhyMask operator|(WhyMask a, WhyMask b) { return a |= b; }
  constexpr bool has(Why why) const { return (bits_ & static_cast<uint16_t>(why)) != 0; }
  constexpr uint16_t bits() const { return bits_; }
  constexpr bool operator==(const WhyMask&) const = default;

 private:
  uint16_t bits_ = 0;
};
constexpr WhyMask operator|(Why a, Why b) {
  return WhyMask(a) | WhyMask(b);
}

/// The content of LOC_Status.
struct LocalizerStatus {
  LocalizerState state = LocalizerState::kInit;
  WhyMask why{};
  TimeSource time_source = TimeSource::kFreeRunning;
  uint8_t camera_ok_mask = 0;  ///< bit i is camera i in the order of the rig
  bool odometry_ok = false;
  bool gnss_ok = false;
  bool map_ok = false;
  uint16_t map_id = 0;

  bool operator==(const LocalizerStatus&) const = default;
};

/// One solution. Whatever is not known is left at its default, which is sent as not available.
struct PoseReport {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  LocalizerStatus status;
  std::optional<Time> capture_time;  ///< of the newest images that went into the pose
  Time pose_time{};                  ///< the moment that pose and velocity are predicted to
  Se2 map_from_vehicle{kUnknown, kUnknown, kUnknown};
  /// Of (x, y, yaw) along the axes of the map: m^2, m rad, rad^2.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Constant(kUnknown);
  double forward_speed_mps = kUnknown;
  double yaw_rate_radps = kUnknown;  ///< positive counter-clockwise
  std::optional<Se2> correction;     ///< the solver's raw dT for these images
};

}  // namespace bevloc::can
