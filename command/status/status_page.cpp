#include "command/status/status_page.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace bevloc::command {
namespace {

/// Returns the value at a path such as "pose.sigma.lateral_m" as text.
std::string text_at(const nlohmann::json& status, const std::string& path,
                    const char* format = "{}") {
  const nlohmann::json* at = &status;
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

std::string list_of(const nlohmann::json& items) {
  std::string text;
  for (const nlohmann::json& item : items) {
    if (item.is_string()) text += (text.empty() ? "" : ", ") + item.get<std::string>();
  }
  return text;
}

/// Returns what /healthz says, unless state and reasons say the same.
std::string health_of(const nlohmann::json& status) {
  const std::string health = text_at(status, "health");
  const bool said = health.starts_with(text_at(status, "state"));
  return status.value("healthy", true) || said ? "" : fmt::format("  {}\n", health);
}

std::string reasons_of(const nlohmann::json& status) {
  std::string text;
  for (const nlohmann::json& why : status.value("why", nlohmann::json::array())) {
    text += fmt::format("  {}: {}\n", text_at(why, "reason"), text_at(why, "do"));
  }
  return text;
}

std::string accuracy_of(const nlohmann::json& status) {
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

std::string cameras_of(const nlohmann::json& status) {
  std::string text =
      "camera      used  captured      lost   dropped  unreadable  failures  faults\n";
  for (const nlohmann::json& camera : status.value("cameras", nlohmann::json::array())) {
    if (!camera.is_object()) continue;
    text += fmt::format("{:12}{:4} {:>9} {:>9} {:>9} {:>11} {:>9}  {}\n", text_at(camera, "name"),
                        camera.value("used", false) ? "yes" : "NO", text_at(camera, "captured"),
                        text_at(camera, "lost"), text_at(camera, "dropped"),
                        text_at(camera, "unreadable"), text_at(camera, "failures"),
                        list_of(camera.value("faults", nlohmann::json::array())));
  }
  return text;
}

std::string head_of(const nlohmann::json& status) {
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

std::string inputs_of(const nlohmann::json& status) {
  std::string text = fmt::format(
      "\nvehicle     {} odometry and {} GNSS samples; {} frames lost, {} refused by E2E\n",
      text_at(status, "vehicle.odometry_samples"), text_at(status, "vehicle.gnss_samples"),
      text_at(status, "vehicle.frames_lost"), text_at(status, "vehicle.e2e_refused"));
  text += fmt::format(
      "            {} epochs incomplete, {} SNA or out of range, {} implausible, {} came too "
      "rarely\n",
      text_at(status, "vehicle.incomplete"), text_at(status, "vehicle.not_available"),
      text_at(status, "vehicle.odometry_refused"), text_at(status, "vehicle.slow_odometry"));
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

std::string framesets_of(const nlohmann::json& status) {
  // Without a latency, the quantiles are 0.
  const bool measured = text_at(status, "latency_ms.count") != "0";
  const auto latency = [&](const char* path) {
    return measured ? text_at(status, path, "{:.0f}") : std::string("-");
  };
  return fmt::format(
      "rate        {} framesets per second; latency {} ms median, {} ms for 99 %\n"
      "framesets   {} taken, {} skipped, {} without a prior, {} with too few usable images\n",
      text_at(status, "rate_hz", "{:.1f}"), latency("latency_ms.median"), latency("latency_ms.p99"),
      text_at(status, "framesets.taken"), text_at(status, "framesets.skipped"),
      text_at(status, "framesets.without_prior"), text_at(status, "framesets.refused"));
}

std::string recording_line(const nlohmann::json& status) {
  if (!status.contains("recording")) return "";
  return fmt::format(
      "recording   {}{} MB; {} images and {} events dropped, {} black boxes kept\n",
      status["recording"].value("failed", false) ? "FAILED after " : "",
      text_at(status, "recording.megabytes", "{:.0f}"), text_at(status, "recording.images_dropped"),
      text_at(status, "recording.events_dropped"), text_at(status, "recording.black_boxes"));
}

}  // namespace

std::string status_page(const nlohmann::json& status) {
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
  text += framesets_of(status) + "\n" + cameras_of(status) + inputs_of(status);
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

}  // namespace bevloc::command
