// CAN in: checked odometry and GNSS off the bus.
#pragma once

#include "can/bus.h"
#include "can/vehicle_input.h"
#include "firmware/messages.h"

namespace bevloc::firmware {

/// Thread: one, the CAN-in thread.
class VehicleInputStage {
 public:
  VehicleInputStage(can::Bus& bus, const can::BaseIds& base, can::GeodeticPosition map_origin,
                    VehicleQueue& samples);

  /// Waits for frames, `timeout` at most, and hands on what they say.
  void step(Duration timeout);

  can::VehicleInputCounters counters() const { return input_.counters(); }

 private:
  can::Bus& bus_;
  can::VehicleInput input_;
  VehicleQueue& samples_;
};

}  // namespace bevloc::firmware
