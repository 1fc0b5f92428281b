// Computes when the frames of a mock camera arrive, and applies its faults.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "drivers/camera/paced_camera.h"
#include "sim/faults/fault_board.h"

namespace bevloc::drivers {

/// The timing of a camera: exposure k starts at drive_start + phase + k * period.
struct CameraTiming {
  Time drive_start;
  Duration period{0};
  Duration phase{0};
  Duration exposure{0};
  Duration readout{0};  ///< from start of exposure to arrival
};

/// Has no clock, so the same calls and faults give the same deliveries. One thread.
class MockSchedule {
 public:
  /// `faults` is null if there are none.
  MockSchedule(const CameraTiming& timing, int camera,
               std::shared_ptr<const sim::FaultBoard> faults);

  /// Starts with the first exposure at or after `now`, which gets sequence number 0.
  void restart(Time now);

  /// Returns the next delivery in the order of arrival.
  Delivery next();

  /// Returns the true start of a delivery's exposure, while its time stamp may be wrong.
  Time true_exposure_start(const Delivery& delivery) const {
    return exposure_start(delivery.sequence + first_index_);
  }

 private:
  Delivery next_in_order();
  Delivery next_exposed();
  std::optional<sim::Fault> active(sim::FaultKind kind, uint64_t index) const;
  Time exposure_start(uint64_t index) const;
  Time scene_time(uint64_t index) const;
  Delivery delivery_of(uint64_t index) const;

  CameraTiming timing_;
  int camera_;
  std::shared_ptr<const sim::FaultBoard> faults_;
  uint64_t first_index_ = 0;
  uint64_t index_ = 0;
  Time latest_due_ = Time::min();
  /// The frame that arrives next: a duplicate or a swapped one.
  std::optional<Delivery> held_back_;
};

}  // namespace bevloc::drivers
