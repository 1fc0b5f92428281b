// Computes when the frames of a mock camera arrive, and applies its faults.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "drivers/camera/paced_camera.h"

namespace bevloc::drivers {

enum class CameraFaultKind : uint8_t {
  kDead,       ///< no frame arrives
  kFrozen,     ///< frames arrive on time and all show the moment `from_s`
  kLate,       ///< frames arrive `delay` too late
  kDrop,       ///< every n-th frame is lost
  kDuplicate,  ///< every n-th frame arrives twice
  kSwap,       ///< every n-th frame arrives after the following one
};

/// A fault of a camera during [from_s, until_s) of the drive.
struct CameraFault {
  CameraFaultKind kind = CameraFaultKind::kDead;
  double from_s = 0.0;
  double until_s = std::numeric_limits<double>::infinity();
  Duration delay{0};  ///< for kLate
  int every = 1;      ///< n for kDrop, kDuplicate and kSwap, counted from the start of the drive
};

/// The timing of a camera: exposure k starts at drive_start + phase + k * period.
struct CameraTiming {
  Time drive_start;
  Duration period{0};
  Duration phase{0};
  Duration exposure{0};
  Duration readout{0};  ///< from start of exposure to arrival
};

/// Has no clock: the same calls give the same deliveries. One thread.
class MockSchedule {
 public:
  MockSchedule(const CameraTiming& timing, std::vector<CameraFault> faults);

  /// Starts with the first exposure at or after `now`, which gets sequence number 0.
  void restart(Time now);

  /// Returns the next delivery in the order of arrival. It is due at Time::max() when the camera
  /// stays dead.
  Delivery next();

 private:
  Delivery next_in_order();
  Delivery next_exposed();
  const CameraFault* active(CameraFaultKind kind, uint64_t index) const;
  Time exposure_start(uint64_t index) const;
  Delivery delivery_of(uint64_t index) const;

  CameraTiming timing_;
  std::vector<CameraFault> faults_;
  uint64_t first_index_ = 0;
  uint64_t index_ = 0;
  Time latest_due_ = Time::min();
  std::optional<Delivery> held_back_;  ///< arrives next: a duplicate or a swapped frame
};

}  // namespace bevloc::drivers
