#include "firmware/telemetry/totals_log.h"

#include <spdlog/spdlog.h>

namespace bevloc::firmware {
namespace {

double milliseconds(Duration duration) {
  return 1e3 * to_seconds(duration);
}

void log_frames(const FrameCounts& frames) {
  spdlog::info(
      "stopped: {} frames captured, {} used, {} dropped ({} displaced by newer frames, {} without "
      "a frameset, {} in skipped framesets, {} under way), {} missed by the cameras",
      frames.captured, frames.used, frames.dropped(), frames.displaced, frames.mismatched,
      frames.skipped, frames.under_way(), frames.missed);
}

void log_unreadable_images(const VisionCounters& vision) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (const uint64_t images = vision.unreadable[camera]; images > 0) {
      spdlog::warn(
          "camera {}: {} unreadable images (damaged JPEG or wrong size); check cable and bandwidth",
          kCameraNames[camera], images);
    }
  }
}

void log_synchrony(const SynchronyCounters& synchrony, uint64_t clock_gaps,
                   const drivers::Trigger* trigger) {
  spdlog::info("framesets: spread at most {:.3f} ms, {} clock gaps",
               milliseconds(synchrony.spread_max), clock_gaps);
  if (trigger == nullptr) return;
  const drivers::TriggerCounters& counters = trigger->counters();
  spdlog::info(
      "trigger: {} pulses, at most {:.3f} ms late, {} skipped, {} failed; {} framesets without a "
      "pulse",
      trigger->pulses().count(), milliseconds(counters.max_lateness), counters.skipped,
      counters.failed, synchrony.off_pulse);
}

void log_bus(const can::BusCounters& bus) {
  const double mean_ms = bus.confirmed == 0 ? 0.0
                                            : milliseconds(bus.confirmation_total) /
                                                  static_cast<double>(bus.confirmed);
  spdlog::info(
      "CAN: {} sent, {} confirmed after {:.2f} ms on average and {:.2f} ms at most; dropped: {} "
      "replaced by newer frames, {} too old, {} while the bus was down",
      bus.sent, bus.confirmed, mean_ms, milliseconds(bus.confirmation_max), bus.send_replaced,
      bus.send_expired, bus.send_bus_down);
  spdlog::info(
      "CAN: {} received ({} timestamped by the controller, {} by the kernel), {} lost, {} ignored; "
      "{} error frames, {} times bus-off, interface lost and reopened {} times",
      bus.received, bus.hardware_stamped, bus.software_stamped, bus.receive_dropped,
      bus.receive_ignored, bus.error_frames, bus.bus_off, bus.reopened);
}

void log_vehicle_input(const can::VehicleInputCounters& input) {
  spdlog::info(
      "vehicle: {} odometry and {} GNSS samples; frames: {} lost, {} with a wrong CRC or length, "
      "{} "
      "repeated, {} out of sequence, {} while not valid, {} incomplete, {} not available, {} with "
      "our identifiers; odometry refused: {} wheels against yaw rate, {} jumps, {} sharp turns",
      input.odometry_samples, input.gnss_samples, input.lost, input.wrong_crc + input.wrong_length,
      input.repeated, input.wrong_sequence, input.not_valid, input.incomplete, input.not_available,
      input.own_ids, input.contradicting_wheels, input.odometry_jumps, input.sharp_turns);
}

void log_authentication(const can::SecocCounters& secoc) {
  spdlog::info(
      "vehicle: {} epochs authentic; refused: {} with a wrong code or replayed, {} incomplete, {} "
      "before the first freshness value",
      secoc.authentic, secoc.wrong_mac, secoc.incomplete, secoc.no_freshness);
}

}  // namespace

void log_totals(const Appliance& appliance, const drivers::Trigger* trigger) {
  log_frames(appliance.frame_counts());
  log_unreadable_images(appliance.vision().counters());
  const FramesetSource& framesets = appliance.vision().framesets();
  log_synchrony(framesets.synchrony(), framesets.counters().clock_gaps, trigger);
  log_bus(appliance.bus().counters());
  log_vehicle_input(appliance.vehicle_input().counters());
  if (const auto* secoc = appliance.vehicle_input().secoc_counters()) log_authentication(*secoc);
}

}  // namespace bevloc::firmware
