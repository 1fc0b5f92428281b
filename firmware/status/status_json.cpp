#include "firmware/status/status_json.h"

#include <nlohmann/json.hpp>

#include "common/version.h"

namespace bevloc::firmware {
namespace {

using nlohmann::json;

const char* name_of(Phase phase) {
  switch (phase) {
    case Phase::kStarting:
      return "starting";
    case Phase::kRunning:
      return "running";
    case Phase::kStandby:
      return "standby";
  }
  return "";
}

json why_of(WhyMask why) {
  json list = json::array();
  for_each_reason(why, [&](Why reason) {
    list.push_back({{"reason", words_of(reason)}, {"do", advice_for(reason)}});
  });
  return list;
}

json in_degrees(const std::array<double, 3>& axes) {
  return {{"longitudinal_m", axes[0]}, {"lateral_m", axes[1]}, {"yaw_deg", degrees(axes[2])}};
}

json pose_of(const PoseSnapshot& pose) {
  if (!pose.known) return nullptr;
  return {{"x_m", pose.map_from_vehicle.x_m},
          {"y_m", pose.map_from_vehicle.y_m},
          {"yaw_deg", degrees(pose.map_from_vehicle.yaw_rad)},
          {"sigma", in_degrees(pose.sigma)},
          {"protection_level", in_degrees(pose.protection_level)},
          {"longitudinal_lateral_covariance_m2", pose.longitudinal_lateral_covariance_m2},
          {"speed_mps", pose.speed_mps},
          {"yaw_rate_degps", degrees(pose.yaw_rate_radps)}};
}

json camera_of(const Telemetry& telemetry, int index) {
  const CameraSnapshot& camera = telemetry.snapshot.cameras[index];
  json faults = json::array();
  if (camera.frozen) faults.push_back("frozen");
  if (camera.dark) faults.push_back("dark");
  if (camera.blinded) faults.push_back("blinded");
  if (camera.dirty) faults.push_back("dirty");
  if (camera.stamps_jumped) faults.push_back("time stamps jumped");
  if (telemetry.view.calibration_fault[index]) faults.push_back("out of place");
  return {{"name", kCameraNames[index]},
          {"used", static_cast<bool>(telemetry.snapshot.estimation.cameras[index])},
          {"captured", camera.captured},
          {"lost", camera.driver.missed()},
          {"dropped", camera.synchronizer.refused()},
          {"missed_framesets", camera.synchronizer.missing},
          {"waited_framesets", camera.synchronizer.waited_for},
          {"unreadable", camera.unreadable},
          {"failures", camera.failures},
          {"faults", faults},
          {"drift_ppm", camera.drift_ppm}};
}

json tracker_of(const OutcomeCounts& outcomes) {
  json counts = json::object();
  for (size_t i = 0; i < outcomes.size(); ++i) {
    counts[std::string(bevloc::name_of(static_cast<TrackerUpdate>(i)))] = outcomes[i];
  }
  return counts;
}

json bus_of(const Snapshot& snapshot) {
  const can::BusCounters& bus = snapshot.bus;
  return {{"condition", can::to_string(snapshot.bus_condition)},
          {"sent", bus.sent},
          {"received", bus.received},
          {"waiting", bus.send_waiting},
          {"send_dropped", bus.send_dropped()},
          {"receive_dropped", bus.receive_dropped},
          {"receive_overruns", bus.receive_overrun},
          {"error_frames", bus.error_frames},
          {"bus_off", bus.bus_off},
          {"confirmation_mean_ms", 1e3 * bus.confirmation_mean_s()},
          {"confirmation_max_ms", to_milliseconds(bus.confirmation_max)}};
}

json vehicle_of(const can::VehicleInputCounters& input) {
  return {
      {"odometry_samples", input.odometry_samples},
      {"gnss_samples", input.gnss_samples},
      {"frames_lost", input.lost},
      {"e2e_refused", input.wrong_crc + input.wrong_length + input.repeated + input.wrong_sequence +
                          input.not_valid},
      {"incomplete", input.incomplete},
      {"not_available", input.not_available},
      {"own_ids", input.own_ids},
      {"slow_odometry", input.slow_odometry},
      {"odometry_refused", input.contradicting_wheels + input.odometry_jumps + input.sharp_turns}};
}

json authentication_of(const can::SecocCounters& secoc) {
  return {{"authentic", secoc.authentic},
          {"wrong_mac", secoc.wrong_mac},
          {"incomplete", secoc.incomplete},
          {"no_freshness", secoc.no_freshness}};
}

json gnss_of(const GnssCounters& gnss) {
  using drivers::GpsdLine;
  uint64_t refused = gnss.gpsd.too_long;
  for (const GpsdLine kind :
       {GpsdLine::kNoFix, GpsdLine::kNoAccuracy, GpsdLine::kNoTime, GpsdLine::kNotSatellites,
        GpsdLine::kOutOfRange, GpsdLine::kNotReadable}) {
    refused += gnss.of(kind);
  }
  uint64_t fixes = 0;
  for (const uint64_t count : gnss.fixes) fixes += count;
  return {{"connected", gnss.connected},
          {"connections_failed", gnss.gpsd.failed},
          {"silences", gnss.gpsd.silent},
          {"samples", gnss.samples},
          {"reports_refused", refused},
          {"fixes_refused", fixes - gnss.samples},
          {"age_max_ms", to_milliseconds(gnss.max_age)}};
}

json recording_of(const RecordingSnapshot& recording) {
  return {{"failed", recording.failed},
          {"megabytes", static_cast<double>(recording.bytes) / 1e6},
          {"images", recording.images},
          {"events", recording.events},
          {"images_dropped", recording.images_dropped},
          {"events_dropped", recording.events_dropped},
          {"black_boxes", recording.black_boxes}};
}

}  // namespace

json status_json(const Telemetry& telemetry, const ProcessUse& process, Duration age) {
  const Snapshot& snapshot = telemetry.snapshot;
  const EstimationSnapshot& estimation = snapshot.estimation;
  const HealthCheck health = check_health(telemetry, age);
  json status{{"version", version()},
              {"phase", name_of(telemetry.phase)},
              {"healthy", health.good},
              {"health", health.reason}};
  if (telemetry.phase != Phase::kRunning) {
    status["valid"] = false;
    return status;
  }
  status["time_s"] = to_seconds(telemetry.time.time_since_epoch());
  status["state"] = to_string(estimation.state);
  status["why"] = why_of(estimation.why);
  status["lost"] = {{"count", estimation.lost}, {"why", to_string(estimation.lost_why)}};
  status["valid"] = pose_is_valid(telemetry, age);
  status["pose"] = pose_of(estimation.pose);
  status["cycles"] = estimation.ticks;
  status["rate_hz"] = telemetry.view.rate_hz;
  status["latency_ms"] = {{"median", estimation.latency.quantile_ms(0.5)},
                          {"p99", estimation.latency.quantile_ms(0.99)},
                          {"count", estimation.latency.total()}};
  json cameras = json::array();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    cameras.push_back(camera_of(telemetry, camera));
  }
  status["cameras"] = std::move(cameras);
  status["framesets"] = {{"taken", snapshot.framesets.taken},
                         {"skipped", snapshot.framesets.skipped},
                         {"without_prior", snapshot.framesets.no_prior},
                         {"refused", snapshot.framesets.refused},
                         {"off_pulse", snapshot.framesets.off_pulse},
                         {"spread_ms", to_milliseconds(snapshot.framesets.spread)}};
  status["tracker"] = {{"odometry", tracker_of(estimation.odometry)},
                       {"gnss", tracker_of(estimation.gnss)},
                       {"corrections", tracker_of(estimation.corrections)}};
  status["vehicle"] = vehicle_of(snapshot.vehicle_input);
  if (snapshot.authentication)
    status["authentication"] = authentication_of(*snapshot.authentication);
  if (snapshot.gnss) status["gnss"] = gnss_of(*snapshot.gnss);
  status["can"] = bus_of(snapshot);
  if (snapshot.recording) status["recording"] = recording_of(*snapshot.recording);
  status["hung_threads"] = telemetry.view.hung;
  status["log_lines_dropped"] = snapshot.log_dropped;
  status["memory_mb"] = process.resident_bytes / 1e6;
  status["cpu_s"] = process.cpu_s;
  return status;
}

}  // namespace bevloc::firmware
