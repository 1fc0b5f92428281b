// The health states of the appliance and the reasons for them (Why), as LOC_Status carries them.
#pragma once

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

/// One reason why the state is not better. The bits are those of the signals LOC_Status.Why_*.
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

const char* to_string(HealthState state);

/// Returns the reasons separated by commas, such as "camera missing, match rejected". Empty when no
/// bit is set.
std::string to_string(WhyMask why);

}  // namespace bevloc
