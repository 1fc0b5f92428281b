#include "evaluation/drive/drive_report.h"

#include <nlohmann/json.hpp>

#include "common/files.h"
#include "common/json_dump.h"

namespace bevloc::evaluation {
namespace {

nlohmann::ordered_json axis_json(const AxisError& error) {
  return {{"mae", error.mae}, {"rmse", error.rmse}, {"p95", error.p95}};
}

/// The errors as JSON. Null without a valid pose, because zeros would look like a perfect drive.
nlohmann::ordered_json pose_json(const PoseError& error, bool has_pose) {
  if (!has_pose) return nullptr;
  return {{"longitudinal_m", axis_json(error.longitudinal_m)},
          {"lateral_m", axis_json(error.lateral_m)},
          {"yaw_deg", axis_json(error.yaw_deg)}};
}

nlohmann::ordered_json latency_json(const LatencyReport& latency) {
  return {{"p50", latency.p50_ms}, {"p99", latency.p99_ms}};
}

std::string axis_row(const char* name, const AxisError& prior, const AxisError& estimate) {
  return fmt::format("{:<18} {:>7.3f} {:>7.3f} {:>7.3f}   {:>7.3f} {:>7.3f} {:>7.3f}\n", name,
                     prior.mae, prior.rmse, prior.p95, estimate.mae, estimate.rmse, estimate.p95);
}

std::string error_table(const DriveReport& report) {
  if (report.poses.empty()) return "pose               never valid\n";
  std::string table =
      fmt::format("{:<18} {:^23}   {:^23}\n", "", "prior (GNSS+odometry)", "bevloc");
  table += fmt::format("{:<18} {:>7} {:>7} {:>7}   {:>7} {:>7} {:>7}\n", "error", "MAE", "RMSE",
                       "p95", "MAE", "RMSE", "p95");
  table += axis_row("longitudinal  m", report.prior.longitudinal_m, report.estimate.longitudinal_m);
  table += axis_row("lateral       m", report.prior.lateral_m, report.estimate.lateral_m);
  table += axis_row("yaw         deg", report.prior.yaw_deg, report.estimate.yaw_deg);
  table += fmt::format("pose               first after {:.1f} s, then valid {:.1f} % of the time\n",
                       report.first_fix_s, 100.0 * report.valid_share);
  return table;
}

/// The latencies, or "none": without a valid pose no image has led to a pose on the bus.
std::string latency_text(const DriveReport& report) {
  if (report.poses.empty()) return "none";
  return fmt::format("p50 {:.1f} ms, p99 {:.1f} ms", report.latency.p50_ms, report.latency.p99_ms);
}

}  // namespace

std::string to_table(const DriveReport& report) {
  std::string table;
  if (report.driven_s < report.duration_s) {
    table = fmt::format("stopped after {:.1f} s of {:.1f} s\n", report.driven_s, report.duration_s);
  }
  table += error_table(report);
  table += fmt::format("frames             {} captured, {} used, {} dropped\n",
                       report.frames.captured, report.frames.used, report.frames.dropped());
  table += "exposure to CAN    " + latency_text(report) + "\n";
  table += fmt::format("CAN frames sent    {}\n", report.can_sent);
  return table;
}

std::string to_json(const DriveReport& report) {
  const bool has_pose = !report.poses.empty();
  const nlohmann::ordered_json json = {
      {"prior", pose_json(report.prior, has_pose)},
      {"estimate", pose_json(report.estimate, has_pose)},
      {"frames",
       {{"captured", report.frames.captured},
        {"used", report.frames.used},
        {"dropped", report.frames.dropped()},
        {"displaced", report.frames.displaced},
        {"mismatched", report.frames.mismatched},
        {"skipped", report.frames.skipped},
        {"under_way", report.frames.under_way()},
        {"missed", report.frames.missed}}},
      {"latency_ms", has_pose ? latency_json(report.latency) : nullptr},
      {"realtime_refusals", report.realtime_refusals},
      {"can", {{"sent", report.can_sent}}},
      {"first_fix_s", has_pose ? nlohmann::ordered_json(report.first_fix_s) : nullptr},
      {"valid_share", report.valid_share},
      {"seed", report.seed},
      {"duration_s", report.duration_s},
      {"driven_s", report.driven_s},
      {"map", report.map},
      {"model", report.model}};
  return json_document(json);
}

Status write_csv(const DriveReport& report, const std::string& path) {
  std::string text =
      "time_s,state,truth_x_m,truth_y_m,truth_yaw_rad,prior_x_m,prior_y_m,prior_yaw_rad,"
      "estimate_x_m,estimate_y_m,estimate_yaw_rad\n";
  const auto pose_text = [](const Se2& pose) {
    return fmt::format(",{:.4f},{:.4f},{:.6f}", pose.x_m, pose.y_m, pose.yaw_rad);
  };
  for (const JudgedPose& judged : report.poses) {
    text +=
        fmt::format("{:.3f},{}{}{}{}\n", judged.time_s, to_string(judged.state),
                    pose_text(judged.truth), pose_text(judged.prior), pose_text(judged.estimate));
  }
  return write_file(path, text);
}

}  // namespace bevloc::evaluation
