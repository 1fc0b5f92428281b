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
  const drivers::SynchronizerCounters& refused = camera.synchronizer;
  return {{"name", kCameraNames[index]},
          {"used", static_cast<bool>(telemetry.snapshot.estimation.cameras[index])},
          {"captured", camera.captured},
          {"lost", camera.driver.no_buffer + camera.driver.overrun + camera.driver.lost +
                       camera.driver.damaged},
          {"dropped", refused.duplicate + refused.out_of_order + refused.late + refused.future +
                          refused.overflow + refused.unmatched},
          {"missed_framesets", refused.missing},
          {"waited_framesets", refused.waited_for},
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
  const double mean_s =
      bus.confirmed == 0 ? 0.0
                         : to_seconds(bus.confirmation_total) / static_cast<double>(bus.confirmed);
  return {{"condition", can::to_string(snapshot.bus_condition)},
          {"sent", bus.sent},
          {"received", bus.received},
          {"waiting", bus.send_waiting},
          {"send_dropped", bus.send_replaced + bus.send_expired + bus.send_bus_down},
          {"receive_dropped", bus.receive_dropped},
          {"receive_overruns", bus.receive_overrun},
          {"error_frames", bus.error_frames},
          {"bus_off", bus.bus_off},
          {"confirmation_mean_ms", 1e3 * mean_s},
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

/// Returns the value at a path such as "pose.sigma.lateral_m" as text.
std::string text_at(const json& status, const std::string& path, const char* format = "{}") {
  const json* at = &status;
  for (size_t start = 0; start <= path.size();) {
    const size_t end = std::min(path.find('.', start), path.size());
    const auto found = at->is_object() ? at->find(path.substr(start, end - start)) : at->end();
    if (!at->is_object() || found == at->end()) return "-";
    at = &*found;
    start = end + 1;
  }
  if (at->is_string()) return at->get<std::string>();
  if (at->is_number_integer()) return fmt::format("{}", at->get<int64_t>());
  if (at->is_number()) return fmt::format(fmt::runtime(format), at->get<double>());
  return "-";
}

std::string list_of(const json& items) {
  std::string text;
  for (const json& item : items) {
    if (item.is_string()) text += (text.empty() ? "" : ", ") + item.get<std::string>();
  }
  return text;
}

/// Returns what /healthz says, unless state and reasons say the same.
std::string health_of(const json& status) {
  const std::string health = text_at(status, "health");
  const bool said = health.starts_with(text_at(status, "state"));
  return status.value("healthy", true) || said ? "" : fmt::format("  {}\n", health);
}

std::string reasons_of(const json& status) {
  std::string text;
  for (const json& why : status.value("why", json::array())) {
    text += fmt::format("  {}: {}\n", text_at(why, "reason"), text_at(why, "do"));
  }
  return text;
}

std::string accuracy_of(const json& status) {
  std::string text = "            longitudinal     lateral         yaw\n";
  for (const auto& [title, key] :
       {std::pair{"sigma", "sigma"}, {"protection", "protection_level"}}) {
    const std::string path = fmt::format("pose.{}.", key);
    text += fmt::format("{:10} {:>11} m {:>9} m {:>7} deg\n", title,
                        text_at(status, path + "longitudinal_m", "{:.2f}"),
                        text_at(status, path + "lateral_m", "{:.2f}"),
                        text_at(status, path + "yaw_deg", "{:.2f}"));
  }
  return text;
}

std::string cameras_of(const json& status) {
  std::string text =
      "camera      used  captured      lost   dropped  unreadable  failures  faults\n";
  for (const json& camera : status.value("cameras", json::array())) {
    if (!camera.is_object()) continue;
    text += fmt::format("{:12}{:4} {:>9} {:>9} {:>9} {:>11} {:>9}  {}\n", text_at(camera, "name"),
                        camera.value("used", false) ? "yes" : "NO", text_at(camera, "captured"),
                        text_at(camera, "lost"), text_at(camera, "dropped"),
                        text_at(camera, "unreadable"), text_at(camera, "failures"),
                        list_of(camera.value("faults", json::array())));
  }
  return text;
}

std::string head_of(const json& status) {
  std::string text = fmt::format(
      "bevlocd {}: {}, pose {}{}\n{}{}", text_at(status, "version"), text_at(status, "state"),
      status.value("valid", false) ? "valid" : "NOT valid",
      status.value("healthy", true) ? "" : ", NOT healthy", health_of(status), reasons_of(status));
  if (text_at(status, "lost.count") != "0" && status.contains("lost")) {
    text += fmt::format("  lost {} times, the latest time because of: {}\n",
                        text_at(status, "lost.count"), text_at(status, "lost.why"));
  }
  return text;
}

std::string inputs_of(const json& status) {
  std::string text = fmt::format(
      "\nvehicle     {} odometry and {} GNSS samples; {} frames lost, {} refused by E2E\n",
      text_at(status, "vehicle.odometry_samples"), text_at(status, "vehicle.gnss_samples"),
      text_at(status, "vehicle.frames_lost"), text_at(status, "vehicle.e2e_refused"));
  if (status.contains("authentication")) {
    text += fmt::format(
        "SecOC       {} epochs authentic; refused: {} wrong code, {} incomplete, {} no freshness\n",
        text_at(status, "authentication.authentic"), text_at(status, "authentication.wrong_mac"),
        text_at(status, "authentication.incomplete"),
        text_at(status, "authentication.no_freshness"));
  }
  if (status.contains("gnss")) {
    text += fmt::format(
        "gpsd        {}; {} samples, {} reports and {} fixes refused, at most {} ms old\n",
        status["gnss"].value("connected", false) ? "connected" : "NOT connected",
        text_at(status, "gnss.samples"), text_at(status, "gnss.reports_refused"),
        text_at(status, "gnss.fixes_refused"), text_at(status, "gnss.age_max_ms", "{:.0f}"));
  }
  return text;
}

std::string recording_line(const json& status) {
  if (!status.contains("recording")) return "";
  return fmt::format(
      "recording   {}{} MB; {} images and {} events dropped, {} black boxes kept\n",
      status["recording"].value("failed", false) ? "FAILED after " : "",
      text_at(status, "recording.megabytes", "{:.0f}"), text_at(status, "recording.images_dropped"),
      text_at(status, "recording.events_dropped"), text_at(status, "recording.black_boxes"));
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

std::string status_page(const json& status) {
  if (!status.is_object()) return "the daemon sent no status\n";
  if (status.value("phase", "running") != "running") {
    return fmt::format("bevlocd {}: {}\n", text_at(status, "version"), text_at(status, "health"));
  }
  std::string text = head_of(status);
  text += fmt::format("\npose        x {} m, y {} m, yaw {} deg in the map; {} m/s\n",
                      text_at(status, "pose.x_m", "{:.2f}"), text_at(status, "pose.y_m", "{:.2f}"),
                      text_at(status, "pose.yaw_deg", "{:.2f}"),
                      text_at(status, "pose.speed_mps", "{:.1f}"));
  text += accuracy_of(status);
  text += fmt::format("rate        {} framesets per second; latency {} ms median, {} ms for 99 %\n",
                      text_at(status, "rate_hz", "{:.1f}"),
                      text_at(status, "latency_ms.median", "{:.0f}"),
                      text_at(status, "latency_ms.p99", "{:.0f}"));
  text += fmt::format("framesets   {} taken, {} skipped, {} without a prior\n\n{}",
                      text_at(status, "framesets.taken"), text_at(status, "framesets.skipped"),
                      text_at(status, "framesets.without_prior"), cameras_of(status));
  text += inputs_of(status);
  text += fmt::format(
      "CAN         {}; {} sent and {} dropped, {} received and {} lost, {} overruns, {} error "
      "frames\n",
      text_at(status, "can.condition"), text_at(status, "can.sent"),
      text_at(status, "can.send_dropped"), text_at(status, "can.received"),
      text_at(status, "can.receive_dropped"), text_at(status, "can.receive_overruns"),
      text_at(status, "can.error_frames"));
  text += recording_line(status);
  text += fmt::format("process     {} MB, {} s of CPU time\n",
                      text_at(status, "memory_mb", "{:.0f}"), text_at(status, "cpu_s", "{:.0f}"));
  return text;
}

}  // namespace bevloc::firmware
