// The CAN-in stage: takes odometry and GNSS from the vehicle's CAN messages.
#pragma once

#include "can/bus/bus.h"
#include "can/messages/vehicle_input.h"
#include "common/published.h"
#include "firmware/stages/messages.h"

namespace bevloc::firmware {

/// Thread-bound: called from the CAN-in thread; counters() is readable from any thread.
class VehicleInputStage {
 public:
  /// `bus` and `samples` must outlive the stage.
  VehicleInputStage(can::Bus& bus, const can::BaseIds& base, can::GeodeticPosition map_origin,
                    VehicleQueue& samples);

  /// Waits for CAN frames, at most `timeout`, and queues the samples that they complete.
  void step(Duration timeout);

  can::VehicleInputCounters counters() const { return counters_.load(); }

 private:
  can::Bus& bus_;
  can::VehicleInput input_;
  VehicleQueue& samples_;
  Published<can::VehicleInputCounters> counters_;
};

}  // namespace bevloc::firmware
