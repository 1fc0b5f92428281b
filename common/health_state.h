// The health states of the appliance and the reasons for them (Why), as the CAN messages carry
// them.
#pragma once

#include <bit>
#include <cstdint>
#include <string>

namespace bevloc {

/// The state of the appliance. The numbers are the values of LOC_Status.State.
enum class HealthState : uint8_t {
  kInit = 0,
  kAcquiring = 1,
  kTracking = 2,
  kDegraded = 3,
  kLost = 4,
  kFault = 5,
};

/// Whether the state means that the pose is valid: TRACKING and DEGRADED.
constexpr bool claims_pose(HealthState state) {
  return state == HealthState::kTracking || state == HealthState::kDegraded;
}

/// One reason why the state is not better. Bits 0 to 15 are those of the signals LOC_Status.Why_*,
/// the bits from 16 on those of LOC_Integrity.Why_*.
enum class Why : uint32_t {
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
  kGnssContradicts = 1u << 16,
  kOdometryContradicts = 1u << 17,
  kMatchContradicts = 1u << 18,
  kClockGap = 1u << 19,
  kOdometryImplausible = 1u << 20,
  kForeignSender = 1u << 21,
};

/// Number of reasons. Their bits are 0 to kWhyCount - 1.
inline constexpr int kWhyCount = std::bit_width(static_cast<uint32_t>(Why::kForeignSender));

/// A set of Why bits.
class WhyMask {
 public:
  constexpr WhyMask() = default;
  constexpr WhyMask(Why why) : bits_(static_cast<uint32_t>(why)) {}
  static constexpr WhyMask from_bits(uint32_t bits) {
    WhyMask mask;
    mask.bits_ = bits;
    return mask;
  }
  constexpr WhyMask& operator|=(WhyMask other) {
    bits_ |= other.bits_;
    return *this;
  }
  friend constexpr WhyMask operator|(WhyMask a, WhyMask b) { return a |= b; }
  constexpr bool has(Why why) const { return (bits_ & static_cast<uint32_t>(why)) != 0; }
  constexpr uint32_t bits() const { return bits_; }
  constexpr bool operator==(const WhyMask&) const = default;

 private:
  uint32_t bits_ = 0;
};
constexpr WhyMask operator|(Why a, Why b) {
  return WhyMask(a) | WhyMask(b);
}

/// Calls `visit(Why)` for each reason of the set, in the order of the bits.
template <typename Visit>
constexpr void for_each_reason(WhyMask why, Visit visit) {
  for (int bit = 0; bit < kWhyCount; ++bit) {
    const auto reason = static_cast<Why>(1u << bit);
    if (why.has(reason)) visit(reason);
  }
}

const char* to_string(HealthState state);

/// Returns the reasons separated by commas, such as "camera missing, match rejected". The text is
/// empty when no bit is set.
std::string to_string(WhyMask why);

}  // namespace bevloc
