// When a mock camera's pictures arrive, and what its faults do to them.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "drivers/camera/paced_camera.h"

namespace bevloc::drivers {

enum class CameraFaultKind : uint8_t {
  kDead,       ///< nothing arrives
  kFrozen,     ///< pictures arrive on time and all show the moment `from_s`
  kLate,       ///< pictures arrive `delay` too late
  kDrop,       ///< every n-th picture never arrives
  kDuplicate,  ///< every n-th picture arrives twice
  kSwap,       ///< every n-th picture arrives after the one that follows it
};

/// One thing that is wrong with a camera during [from_s, until_s) of the drive.
struct CameraFault {
  CameraFaultKind kind = CameraFaultKind::kDead;
  double from_s = 0.0;
  double until_s = std::numeric_limits<double>::infinity();
  Duration delay{0};  ///< of kLate
  int every = 1;      ///< n of kDrop, kDuplicate and kSwap; counted from the start of the drive
};

/// The beat of a camera: exposure k starts at drive_start + phase + k * period.
struct CameraTiming {
  Time drive_start;
  Duration period{0};
  Duration phase{0};
  Duration exposure{0};
  Duration readout{0};  ///< from start of exposure to arrival
};

/// Pure arithmetic, no clock; the same deliveries each time.
class MockSchedule {
 public:
  MockSchedule(const CameraTiming& timing, std::vector<CameraFault> faults);

  /// Begins with the first exposure at or after `now`, which gets sequence 0.
  void restart(Time now);

  /// In the order of arrival. Due at Time::max() once the camera is dead for ever.
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
  std::optional<Delivery> held_back_;  ///< arrives next: a duplicate, or one that was overtaken
};

}  // namespace bevloc::drivers
