#include "firmware/status/totals_log.h"

#include <spdlog/spdlog.h>

namespace bevloc::firmware {
namespace {

void log_frames(const FrameCounts& frames) {
  spdlog::info(
      "stopped: {} frames captured, {} used, {} dropped ({} displaced by newer frames, {} without "
      "a frameset, {} in skipped framesets, {} under way), {} missed by the cameras",
      frames.captured, frames.used, frames.dropped(), frames.displaced, frames.mismatched,
      frames.skipped, frames.under_way(), frames.missed);
}

void log_cameras(const std::array<CameraSnapshot, kCameraCount>& cameras) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const CameraSnapshot& counts = cameras[camera];
    if (counts.failures > 0) {
      spdlog::info("camera {}: failed {} times", kCameraNames[camera], counts.failures);
    }
    if (counts.unreadable > 0) {
      spdlog::warn("camera {}: {} unreadable images; the log above gives the reason",
                   kCameraNames[camera], counts.unreadable);
    }
  }
}

void log_framesets(const FramesetsSnapshot& framesets,
                   const std::optional<TriggerSnapshot>& trigger) {
  spdlog::info(
      "framesets: spread at most {:.3f} ms; {} taken, {} without a prior, {} with too few readable "
      "images; network checked {} times",
      to_milliseconds(framesets.spread_max), framesets.taken, framesets.no_prior, framesets.refused,
      framesets.network_checks);
  if (!trigger) return;
  spdlog::info(
      "trigger: {} pulses, at most {:.3f} ms late, {} skipped, {} failed; {} framesets without a "
      "pulse",
      trigger->pulses, to_milliseconds(trigger->max_lateness), trigger->skipped, trigger->failed,
      framesets.off_pulse);
}

void log_queues(const QueueDrops& drops) {
  if (drops.samples + drops.reports == 0) return;
  spdlog::warn("queues: {} samples of odometry and GNSS and {} reports of vision dropped",
               drops.samples, drops.reports);
}

void log_tracker(const char* input, const OutcomeCounts& outcomes) {
  std::string text;
  for (size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", outcomes[i],
                        name_of(static_cast<TrackerUpdate>(i)));
  }
  spdlog::info("tracker: {}: {}", input, text.empty() ? "none" : text);
}

void log_bus(const can::BusCounters& bus) {
  spdlog::info(
      "CAN: {} sent, {} confirmed after {:.2f} ms on average and {:.2f} ms at most; dropped: {} "
      "replaced by newer frames, {} too old, {} while the bus was down",
      bus.sent, bus.confirmed, 1e3 * bus.confirmation_mean_s(),
      to_milliseconds(bus.confirmation_max), bus.send_replaced, bus.send_expired,
      bus.send_bus_down);
  spdlog::info(
      "CAN: {} received ({} timestamped by the controller, {} by the kernel), {} lost, {} overruns "
      "of "
      "the controller, {} ignored; {} error frames, {} times bus-off, interface lost and reopened "
      "{} times",
      bus.received, bus.hardware_stamped, bus.software_stamped, bus.receive_dropped,
      bus.receive_overrun, bus.receive_ignored, bus.error_frames, bus.bus_off, bus.reopened);
}

void log_vehicle_input(const can::VehicleInputCounters& input) {
  spdlog::info(
      "vehicle: {} odometry and {} GNSS samples; frames: {} lost, {} with a wrong CRC or length, "
      "{} repeated, {} out of sequence, {} while not valid, {} incomplete, {} not available, {} "
      "with our identifiers, {} of other messages; odometry refused: {} wheels against yaw rate, "
      "{} jumps, {} sharp turns; {} samples came too rarely",
      input.odometry_samples, input.gnss_samples, input.lost, input.wrong_crc + input.wrong_length,
      input.repeated, input.wrong_sequence, input.not_valid, input.incomplete, input.not_available,
      input.own_ids, input.foreign, input.contradicting_wheels, input.odometry_jumps,
      input.sharp_turns, input.slow_odometry);
}

void log_gnss(const GnssCounters& gnss) {
  using drivers::FixVerdict;
  using drivers::GpsdLine;
  spdlog::info(
      "gpsd: {} samples, at most {:.0f} ms old; reports refused: {} without a fix, {} without "
      "accuracy or time, {} not of satellites, {} out of range, {} not readable or too long; fixes "
      "refused: {} to learn the delay, {} repeated, {} stale, {} from the future, {} while the "
      "clock was not synchronized; connected {} times, {} attempts failed, silent {} times",
      gnss.samples, to_milliseconds(gnss.max_age), gnss.of(GpsdLine::kNoFix),
      gnss.of(GpsdLine::kNoAccuracy) + gnss.of(GpsdLine::kNoTime),
      gnss.of(GpsdLine::kNotSatellites), gnss.of(GpsdLine::kOutOfRange),
      gnss.of(GpsdLine::kNotReadable) + gnss.gpsd.too_long, gnss.of(FixVerdict::kLearning),
      gnss.of(FixVerdict::kRepeated), gnss.of(FixVerdict::kStale), gnss.of(FixVerdict::kFuture),
      gnss.of(FixVerdict::kUnsynchronized), gnss.gpsd.connected, gnss.gpsd.failed,
      gnss.gpsd.silent);
}

void log_authentication(const can::SecocCounters& secoc) {
  spdlog::info(
      "vehicle: {} epochs authentic; refused: {} with a wrong code or replayed, {} incomplete or "
      "without authentication, {} before the freshness of the sender was known; frames refused: {} "
      "with a wrong length, {} announcements with a wrong CRC",
      secoc.authentic, secoc.wrong_mac, secoc.incomplete, secoc.no_freshness, secoc.wrong_length,
      secoc.bad_announcements);
}

}  // namespace

void log_totals(const Snapshot& snapshot) {
  log_frames(snapshot.frames);
  log_cameras(snapshot.cameras);
  log_framesets(snapshot.framesets, snapshot.trigger);
  log_queues(snapshot.queue_drops);
  log_vehicle_input(snapshot.vehicle_input);
  if (snapshot.authentication) log_authentication(*snapshot.authentication);
  if (snapshot.gnss) log_gnss(*snapshot.gnss);
  if (snapshot.estimation.lost > 0) {
    spdlog::warn("pose: lost {} times, the latest time because of: {}", snapshot.estimation.lost,
                 to_string(snapshot.estimation.lost_why));
  }
  log_tracker("odometry", snapshot.estimation.odometry);
  log_tracker("GNSS", snapshot.estimation.gnss);
  log_tracker("corrections", snapshot.estimation.corrections);
  if (snapshot.estimation.clock_gaps > 0 || snapshot.framesets.clock_gaps > 0) {
    spdlog::warn("clock: {} gaps seen by CAN out, {} by vision", snapshot.estimation.clock_gaps,
                 snapshot.framesets.clock_gaps);
  }
  log_bus(snapshot.bus);
  if (snapshot.log_dropped > 0) spdlog::warn("log: {} lines dropped", snapshot.log_dropped);
}

}  // namespace bevloc::firmware
