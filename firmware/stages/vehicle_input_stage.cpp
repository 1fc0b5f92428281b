#include "firmware/stages/vehicle_input_stage.h"

namespace bevloc::firmware {

VehicleInputStage::VehicleInputStage(can::Bus& bus, const can::BaseIds& base,
                                     can::GeodeticPosition map_origin, VehicleQueue& samples)
    : bus_(bus), input_(base, map_origin), samples_(samples) {}

void VehicleInputStage::step(Duration timeout) {
  if (!bus_.wait(timeout)) return;
  while (const auto received = bus_.receive()) {
    if (const auto sample = input_.accept(*received)) samples_.push(*sample);
  }
  counters_.store(input_.counters());
}

}  // namespace bevloc::firmware
