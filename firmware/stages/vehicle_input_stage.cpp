#include "firmware/stages/vehicle_input_stage.h"

namespace bevloc::firmware {

VehicleInputStage::VehicleInputStage(can::Bus& bus, const can::BaseIds& base,
                                     can::GeodeticPosition map_origin, VehicleQueue& samples,
                                     const can::OdometryLimits& limits)
    : bus_(bus), input_(base, map_origin, limits), samples_(samples) {}

void VehicleInputStage::step(Duration timeout) {
  if (!bus_.wait(timeout)) return;
  while (const auto received = bus_.receive()) {
    if (secoc_) {
      take_authentic(*received);
    } else {
      take(*received);
    }
  }
  counters_.store(input_.counters());
  if (secoc_) secoc_counters_.store(secoc_->counters());
}

void VehicleInputStage::take(const can::ReceivedFrame& received) {
  const auto sample = input_.accept(received);
  WhyMask why = input_.why();
  const bool forged = forged_ && received.received - *forged_ <= can::VehicleInput::kWhyHold;
  if (forged) why |= Why::kForeignSender;
  why_ = why.bits();  // before the sample, so that whoever reads the sample knows it
  if (sample) samples_.push(*sample);
}

void VehicleInputStage::take_authentic(const can::ReceivedFrame& received) {
  const uint64_t wrong_before = secoc_->counters().wrong_mac;
  const auto authentic = secoc_->accept(received);
  if (secoc_->counters().wrong_mac != wrong_before) {
    forged_ = received.received;
    why_ |= WhyMask(Why::kForeignSender).bits();
  }
  for (const can::ReceivedFrame& frame : authentic) take(frame);
}

}  // namespace bevloc::firmware
