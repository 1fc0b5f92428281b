#include "evaluation/campaign/campaign_report.h"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_dump.h"

namespace bevloc::evaluation {
namespace {

using nlohmann::json;

double rounded(double value) {
  return std::round(1e3 * value) / 1e3;
}

json json_of(const std::optional<double>& value) {
  return value ? json(rounded(*value)) : json();
}

json shares_of(const PoseCounts& counts, uint64_t all) {
  json shares = json::array();
  for (const uint64_t count : counts) {
    shares.push_back(all == 0 ? json()
                              : json(static_cast<double>(count) / static_cast<double>(all)));
  }
  return shares;
}

json json_of(const CampaignRow& row, Level level) {
  const RunOutcome& outcome = row.outcome;
  json object;
  object["mode"] = row.mode->name;
  object["level"] = level == Level::kStage ? "stage" : "pictures";
  object["what"] = row.mode->what;
  object["seed"] = row.seed;
  object["detected_by"] = outcome.detected_by.empty() ? json() : json(outcome.detected_by);
  object["detection_s"] = json_of(outcome.detection_s);
  object["valid_beyond_alert_s"] = rounded(outcome.beyond_alert_s());
  object["limit_s"] = row.mode->limit_s;
  object["fault_ends"] = row.fault_ends;
  object["worst"] = {rounded(outcome.worst(0)), rounded(outcome.worst(1)),
                     rounded(degrees(outcome.worst(2)))};
  object["recovery_s"] = json_of(outcome.recovery_s);
  object["valid_share"] = outcome.valid_share();
  object["first_fix_s"] = rounded(outcome.first_fix_s);
  object["lost"] = outcome.lost;
  object["false_lost"] = outcome.false_lost;
  object["valid_poses"] = outcome.valid;
  object["within_1_sigma"] = shares_of(outcome.within_sigma[0], outcome.valid);
  object["within_2_sigma"] = shares_of(outcome.within_sigma[1], outcome.valid);
  object["within_3_sigma"] = shares_of(outcome.within_sigma[2], outcome.valid);
  object["with_protection_level"] = outcome.protection.with_level;
  object["misleading"] = outcome.protection.misleading;
  object["hazardous"] = outcome.protection.hazardous;
  object["protection_under_alert_limit"] = outcome.protection.available;
  return object;
}

std::string seconds(const std::optional<double>& value) {
  return value ? fmt::format("{:.2f}", *value) : "-";
}

}  // namespace

std::string to_json(const std::vector<CampaignRow>& rows, Level level) {
  std::string text = "[\n";
  for (size_t i = 0; i < rows.size(); ++i) {
    text += dump_json(json_of(rows[i], level)) + (i + 1 < rows.size() ? ",\n" : "\n");
  }
  return text + "]\n";
}

std::string text_head() {
  return fmt::format("{:26} {:>6} {:>28} {:>7} {:>8} {:>22} {:>7} {:>6} {:>5} {:>15}\n", "mode",
                     "seed", "detected by", "after s", "beyond s", "worst m, m, deg", "recov s",
                     "valid", "lost", "3 sigma %");
}

std::string to_text(const CampaignRow& row) {
  const RunOutcome& outcome = row.outcome;
  const auto share = [&outcome](size_t axis) {
    return outcome.valid == 0 ? 0.0
                              : 100.0 * static_cast<double>(outcome.within_sigma[2][axis]) /
                                    static_cast<double>(outcome.valid);
  };
  const std::string worst = fmt::format("{:.2f} {:.2f} {:.2f}", outcome.worst(0), outcome.worst(1),
                                        degrees(outcome.worst(2)));
  const std::string sigmas = fmt::format("{:.0f} {:.0f} {:.0f}", share(0), share(1), share(2));
  return fmt::format(
      "{:26} {:>6} {:>28} {:>7} {:>8.2f} {:>22} {:>7} {:>5.1f}% {:>5} {:>15}\n", row.mode->name,
      row.seed, outcome.detected_by.empty() ? "-" : outcome.detected_by,
      seconds(outcome.detection_s), outcome.beyond_alert_s(), worst, seconds(outcome.recovery_s),
      100.0 * outcome.valid_share(), outcome.lost, sigmas);
}

std::string timeline_of(const CampaignRow& row) {
  std::string text;
  for (const TimelineEntry& entry : row.outcome.timeline) {
    text += fmt::format("  {:8.2f} s  {:10} {}\n", entry.time_s, to_string(entry.state),
                        names_of(entry.why));
  }
  return text;
}

}  // namespace bevloc::evaluation
