#include "firmware/stages/vehicle_input_stage.h"

#include <algorithm>

#include "firmware/threads/clock_gap.h"

namespace bevloc::firmware {

VehicleInputStage::VehicleInputStage(can::Bus& bus, std::unique_ptr<can::VehicleDecoder> decoder,
                                     VehicleQueue& samples)
    : bus_(bus), decoder_(std::move(decoder)), samples_(samples) {}

void VehicleInputStage::step(const drivers::Clock& clock, Duration timeout) {
  const bool has_frames = bus_.wait(timeout);
  note_suspension(clock);
  if (!has_frames) return;
  while (const auto received = bus_.receive()) {
    if (secoc_) {
      take_authentic(*received);
    } else {
      take(*received);
    }
  }
  counters_.store(decoder_->counters());
  if (secoc_) secoc_counters_.store(secoc_->counters());
}

void VehicleInputStage::note_suspension(const drivers::Clock& clock) {
  const Duration suspended = clock.suspended();
  if (suspended - suspended_ > ClockGapDetector::kSuspension) decoder_->note_gap();
  suspended_ = suspended;
}

void VehicleInputStage::take(const can::ReceivedFrame& received) {
  const can::VehicleSamples samples = decoder_->accept(received);
  publish_faults();  // before the samples, so that a reader of a sample sees them
  if (samples.odometry) samples_.push(*samples.odometry);
  if (samples.gnss && !ignores_gnss_) samples_.push(*samples.gnss);
}

void VehicleInputStage::take_authentic(const can::ReceivedFrame& received) {
  const uint64_t wrong_before = secoc_->counters().wrong_mac;
  const auto authentic = secoc_->accept(received);
  if (secoc_->counters().wrong_mac != wrong_before) {
    forged_ = received.received;
    publish_faults();
  }
  for (const can::ReceivedFrame& frame : authentic) take(frame);
}

void VehicleInputStage::publish_faults() {
  can::VehicleFaultTimes times = decoder_->fault_times();
  times.foreign_sender = std::max(times.foreign_sender, forged_);
  fault_times_.store(times);
}

}  // namespace bevloc::firmware
