// A fault of one input of the simulated appliance: what goes wrong, when, and by how much.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

namespace bevloc::sim {

/// Every kind is described in fault_table.cpp and in docs/simulation.md.
enum class FaultKind : uint8_t {
  kGnssJump,
  kGnssRamp,
  kGnssSpoof,
  kGnssNoise,
  kGnssWrongSigma,
  kGnssNoHeading,
  kGnssOutage,
  kGnssStuck,
  kGnssLate,
  kOdometryStuck,
  kOdometryScaled,
  kOdometrySlip,
  kOdometryLock,
  kOdometryReversed,
  kOdometrySlow,
  kOdometryLate,
  kOdometryMissing,
  kOdometryWheels,
  kYawRateBias,
  kYawRateScaled,
  kYawRateWrong,
  kCameraDead,
  kCameraFrozen,
  kCameraLoop,
  kCameraLate,
  kCameraDrop,
  kCameraDuplicate,
  kCameraOutOfOrder,
  kCameraTimeShift,
  kCameraDark,
  kCameraBlinded,
  kCameraDirty,
  kCameraSwapped,
  kCameraTurned,
  kCameraMoved,
  kMapShifted,
  kMapCut,
  kMapOfElsewhere,
  kMapBorderOff,
  kWorldGrass,
  kClockGap,
  kClockSuspend,
  kWallClockStep,
  kBusOff,
  kBusNoAcknowledge,
  kBusFlooded,
  kBusForged,
  kBusReplayed,
  kHangCapture,
  kHangVision,
  kHangCanIn,
  kHangCanOut,
};

/// The amounts of all kinds. A kind uses those that the fault table names; the others stay 0.
struct FaultAmounts {
  double east_m = 0.0;
  double north_m = 0.0;
  double along_m = 0.0;   ///< forward along the vehicle
  double across_m = 0.0;  ///< to the left of the vehicle
  double heading_deg = 0.0;
  double east_mps = 0.0;
  double north_mps = 0.0;
  double along_mps = 0.0;
  double across_mps = 0.0;
  double pull_s = 0.0;
  double factor = 0.0;
  double period_ms = 0.0;
  double left_mps = 0.0;
  double right_mps = 0.0;
  double bias_degps = 0.0;
  double yaw_rate_degps = 0.0;
  double delay_ms = 0.0;
  double every = 0.0;     ///< a whole number
  double pictures = 0.0;  ///< a whole number
  double shift_ms = 0.0;
  double brightness = 0.0;
  double strength = 0.0;
  double share = 0.0;
  double yaw_deg = 0.0;
  double pitch_deg = 0.0;
  double roll_deg = 0.0;
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double radius_m = 0.0;
  double seed = 0.0;  ///< a whole number
  double outwards_m = 0.0;
  double inside_m = 0.0;
  double gap_s = 0.0;
  double step_s = 0.0;
  double stale_frames = 0.0;  ///< a whole number
  double rate_hz = 0.0;
  double loss = 0.0;
  double speed_mps = 0.0;
  double counter_step = 0.0;  ///< a whole number
  double age_s = 0.0;
};

/// A fault that is active during [from_s, until_s) of the drive.
struct Fault {
  FaultKind kind = FaultKind::kGnssOutage;
  double from_s = 0.0;
  double until_s = std::numeric_limits<double>::infinity();
  std::optional<int> camera{};        ///< index into kCameraNames; empty for all cameras
  std::optional<int> other_camera{};  ///< the second camera of kCameraSwapped
  FaultAmounts amounts{};

  bool is_active(double time_s) const { return time_s >= from_s && time_s < until_s; }
  /// Whether a fault of cameras affects the camera `index`.
  bool concerns(int index) const { return !camera || camera == index || other_camera == index; }
};

}  // namespace bevloc::sim
