#include "firmware/status/error_log.h"

#include <system_error>
#include <utility>

#include <spdlog/spdlog.h>

namespace bevloc::firmware {
namespace {

/// Answers of the tracker that mean a defect of the input. The others are part of normal operation.
constexpr std::array<std::pair<TrackerUpdate, const char*>, 4> kRefusals = {{
    {TrackerUpdate::kTooOld, "too old; check its time stamps and the load of this machine"},
    {TrackerUpdate::kOutOfOrder, "out of order; check its time stamps"},
    {TrackerUpdate::kNotFinite, "not a number; send the journal"},
    {TrackerUpdate::kImplausible,
     "beyond a physical limit, stuck, or of the wrong sign; check sensor and scaling"},
}};

/// The number of epochs in about five seconds. The receiver always refuses the epochs of about the
/// first second after a start.
constexpr uint64_t kEpochsOfAStart = 300;

}  // namespace

void ErrorLog::note(const Snapshot& snapshot, Time now) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    note_camera(camera, snapshot.cameras[camera], now);
  }
  note_vehicle_input(snapshot.vehicle_input, now);
  if (snapshot.authentication) note_authentication(*snapshot.authentication, now);
  if (snapshot.gnss) note_gnss(*snapshot.gnss, now);
  note_tracker(snapshot.estimation, now);
  note_queues(snapshot.queue_drops, now);
  note_bus(snapshot.bus, now);
}

void ErrorLog::count(const std::string& text, uint64_t total, Time now) {
  if (total == 0) return;
  Count& count = counts_[text];
  if (total == count.seen) return;
  const bool is_new = count.seen == 0 || now - count.grown >= CauseLog::kQuiet;
  count = {total, now};
  if (is_new) spdlog::warn("{} (counted {} times)", text, total);
}

void ErrorLog::note_camera(int camera, const CameraSnapshot& snapshot, Time now) {
  const auto count_camera = [&](std::string_view text, uint64_t total) {
    if (total > 0) count(fmt::format("camera {}: {}", kCameraNames[camera], text), total, now);
  };
  count_camera("damaged frame; check cable and bandwidth", snapshot.driver.damaged);
  count_camera("frame lost before the driver; check cable, bandwidth and the load of this machine",
               snapshot.driver.lost);
  count_camera("no free buffer for a frame; raise cameras.buffers", snapshot.driver.no_buffer);
  count_camera("frame not fetched in time; check the load of this machine",
               snapshot.driver.overrun);
  count_camera(
      "frame dropped because newer ones filled its queue; check the load of this machine, or lower "
      "the frame rate",
      snapshot.synchronizer.overflow);
  count_camera("frame came after its frameset was complete; raise cameras.wait_ms",
               snapshot.synchronizer.late);
  count_camera("frame older than the one before it; check its time stamps",
               snapshot.synchronizer.out_of_order);
  count_camera("two frames with the same time; check its time stamps",
               snapshot.synchronizer.duplicate);
  count_camera("frame from the future; check its time stamps", snapshot.synchronizer.future);
}

void ErrorLog::note_vehicle_input(const can::VehicleInputCounters& input, Time now) {
  count("CAN in: found a wrong CRC, wanted the vehicle's E2E profile; check data id and sender",
        input.wrong_crc, now);
  count("CAN in: found a wrong length, wanted that of the DBC file; check the sender",
        input.wrong_length, now);
  count("CAN in: found a repeated counter; check for a second sender of the identifiers",
        input.repeated, now);
  count("CAN in: found a gap in the counter; check bus load and sender", input.lost, now);
  count("CAN in: found an epoch with a missing message; check bus load and sender",
        input.incomplete, now);
  count("CAN in: found a signal that is not available or out of range; check the sender",
        input.not_available, now);
  count("CAN in: found odometry that comes too seldom; check the cycle of the sender's messages",
        input.slow_odometry, now);
  count("CAN in: found wheel speeds that contradict the yaw rate; check both sensors",
        input.contradicting_wheels, now);
  count("CAN in: found a change of odometry that no vehicle can make; check the sensors",
        input.odometry_jumps + input.sharp_turns, now);
}

void ErrorLog::note_authentication(const can::SecocCounters& secoc, Time now) {
  count(
      "CAN in: found an epoch with a wrong authentication code or a replayed one; compare the key "
      "files of vehicle and localizer, and look for a foreign sender",
      secoc.wrong_mac, now);
  count(
      "CAN in: found an authentication without all frames of its epoch; check bus load and sender",
      secoc.incomplete, now);
  if (secoc.authentic > 0 || secoc.no_freshness < kEpochsOfAStart) return;
  count(
      "CAN in: found epochs, but no freshness value of their sender; check that it sends "
      "VEH_Freshness",
      secoc.no_freshness, now);
}

void ErrorLog::note_gnss(const GnssCounters& gnss, Time now) {
  using drivers::FixVerdict;
  using drivers::GpsdLine;
  if (gnss.gpsd.failed > 0) {
    count(
        fmt::format("gpsd: cannot be reached ({}); check that it runs, gnss.address and gnss.port, "
                    "and that the drop-in gnss.conf is installed",
                    std::generic_category().message(gnss.gpsd.failure)),
        gnss.gpsd.failed, now);
  }
  count("gpsd: found no report for 10 s, wanted one a second; check the receiver and gnss.device",
        gnss.gpsd.silent, now);
  count("gpsd: found a line that is not JSON or too long; check that gnss.port is that of gpsd",
        gnss.of(GpsdLine::kNotReadable) + gnss.gpsd.too_long, now);
  count(
      "gpsd: found a fix without accuracy (epx and epy, or eph) or time; check the receiver's "
      "messages",
      gnss.of(GpsdLine::kNoAccuracy) + gnss.of(GpsdLine::kNoTime), now);
  count("gpsd: found a value that no receiver can have; check the receiver",
        gnss.of(GpsdLine::kOutOfRange), now);
  count("gpsd: found dead reckoning or a simulation, wanted satellites; check the receiver's setup",
        gnss.of(GpsdLine::kNotSatellites), now);
  count("gpsd: found a fix that is too old; check the receiver's rate and the load of this machine",
        gnss.of(FixVerdict::kStale), now);
  count("gpsd: found a fix from the future; check that the system clock is UTC",
        gnss.of(FixVerdict::kFuture), now);
  count(
      "gpsd: found a system clock that is not synchronized, or whose error may exceed 100 ms; "
      "check chrony or linuxptp, and that the drop-in clock.conf is installed, or choose "
      "gnss.timing: arrival",
      gnss.of(FixVerdict::kUnsynchronized), now);
  count("gpsd: found the same fix twice; choose one receiver with gnss.device",
        gnss.of(FixVerdict::kRepeated), now);
}

void ErrorLog::note_tracker(const EstimationSnapshot& estimation, Time now) {
  const std::array<std::pair<const char*, const OutcomeCounts*>, 3> inputs = {
      {{"odometry", &estimation.odometry},
       {"GNSS", &estimation.gnss},
       {"correction", &estimation.corrections}}};
  for (const auto& [input, outcomes] : inputs) {
    for (const auto& [outcome, what_to_do] : kRefusals) {
      const uint64_t total = (*outcomes)[static_cast<size_t>(outcome)];
      if (total > 0) count(fmt::format("tracker: {} refused: {}", input, what_to_do), total, now);
    }
  }
}

/// Predictions are not among these: vision needs only the latest ones.
void ErrorLog::note_queues(const QueueDrops& drops, Time now) {
  count(
      "samples of odometry or GNSS dropped because CAN out did not read them in time; check the "
      "load of this machine",
      drops.samples, now);
  count(
      "reports of vision dropped because CAN out did not read them in time; check the load of "
      "this machine",
      drops.reports, now);
}

void ErrorLog::note_bus(const can::BusCounters& bus, Time now) {
  count("CAN in: frames lost because they were not read in time; check the load of this machine",
        bus.receive_dropped, now);
  count(
      "CAN in: the controller lost frames; check its driver, the interrupt load and the SPI clock",
      bus.receive_overrun, now);
  count("CAN out: frames dropped because they were too old; check bus load and acknowledgement",
        bus.send_expired, now);
  count(
      "CAN out: frames replaced by newer ones because the bus had no room; check bus load and "
      "txqueuelen",
      bus.send_replaced, now);
}

}  // namespace bevloc::firmware
