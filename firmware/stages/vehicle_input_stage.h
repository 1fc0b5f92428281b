// The CAN-in stage: takes odometry and GNSS from the vehicle's CAN messages.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "can/bus/bus.h"
#include "can/messages/vehicle_decoder.h"
#include "can/secoc/secoc_receiver.h"
#include "common/published.h"
#include "drivers/clock/clock.h"
#include "firmware/stages/messages.h"

namespace bevloc::firmware {

/// Thread-bound: called from the CAN-in thread. why(), counters() and secoc_counters() are readable
/// from any thread.
class VehicleInputStage {
 public:
  /// `bus` and `samples` must outlive the stage.
  VehicleInputStage(can::Bus& bus, std::unique_ptr<can::VehicleDecoder> decoder,
                    VehicleQueue& samples);

  /// From now on, uses only frames that are authentic.
  void authenticate(can::SecocReceiver receiver) { secoc_.emplace(std::move(receiver)); }

  /// From now on, drops the positions of the bus, because GNSS comes from elsewhere.
  void ignore_gnss() { ignores_gnss_ = true; }

  /// Waits for CAN frames, at most `timeout`, and queues the samples that they complete.
  void step(const drivers::Clock& clock, Duration timeout);

  /// Returns what is wrong with the vehicle's messages at `now`: kOdometryImplausible,
  /// kForeignSender, both or none. Frames that are not authentic count as those of a foreign
  /// sender.
  WhyMask why(Time now) const { return fault_times_.load().why(now); }

  can::VehicleInputCounters counters() const { return counters_.load(); }
  /// Returns nothing without authentication.
  std::optional<can::SecocCounters> secoc_counters() const {
    return secoc_ ? std::optional(secoc_counters_.load()) : std::nullopt;
  }

 private:
  void take(const can::ReceivedFrame& received);
  void take_authentic(const can::ReceivedFrame& received);
  void publish_faults();
  void note_suspension(const drivers::Clock& clock);

  can::Bus& bus_;
  const std::unique_ptr<can::VehicleDecoder> decoder_;
  VehicleQueue& samples_;
  Duration suspended_{};  ///< Clock::suspended() at the latest step
  Published<can::VehicleInputCounters> counters_;
  Published<can::SecocCounters> secoc_counters_;
  bool ignores_gnss_ = false;
  std::optional<can::SecocReceiver> secoc_;
  std::optional<Time> forged_;  ///< when the latest frame came that was not authentic
  Published<can::VehicleFaultTimes> fault_times_;
};

}  // namespace bevloc::firmware
