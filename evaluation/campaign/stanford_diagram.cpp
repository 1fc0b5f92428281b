#include "evaluation/campaign/stanford_diagram.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/alert_limits.h"
#include "common/json_dump.h"

namespace bevloc::evaluation {
namespace {

constexpr std::array<const char*, 3> kAxisNames = {"longitudinal", "lateral", "yaw"};
constexpr std::array<const char*, 3> kAxisUnits = {"m", "m", "deg"};

int bin_of(double value, double limit) {
  const double bin = StanfordDiagram::kBinsPerLimit * value / limit;
  return static_cast<int>(std::min(bin, StanfordDiagram::kBins - 1.0));
}

double in_unit(int axis, double value) {
  return axis == 2 ? degrees(value) : value;
}

double share(uint64_t part, uint64_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

nlohmann::json json_of_axis(const StanfordDiagram& diagram, int axis) {
  const StanfordDiagram::Axis& counted = diagram.axis(axis);
  const ProtectionCounts& protection = diagram.protection();
  const auto at = static_cast<size_t>(axis);
  const double limit = in_unit(axis, kFreewayAlertLimits(axis));
  nlohmann::json object;
  object["axis"] = kAxisNames[at];
  object["unit"] = kAxisUnits[at];
  object["alert_limit"] = limit;
  object["bin"] = limit / StanfordDiagram::kBinsPerLimit;
  object["bins"] = StanfordDiagram::kBins;
  object["counts"] = counted.counts;
  object["with_protection_level"] = protection.with_level[at];
  object["misleading"] = protection.misleading[at];
  object["misleading_share"] = share(protection.misleading[at], protection.with_level[at]);
  object["hazardous"] = protection.hazardous[at];
  object["hazardous_share"] = share(protection.hazardous[at], protection.with_level[at]);
  object["available_share"] = share(protection.available[at], diagram.cycles());
  object["worst_excess"] = in_unit(axis, counted.worst_excess);
  return object;
}

}  // namespace

void StanfordDiagram::begin_drive() {
  ++drives_;
  latest_s_.reset();
}

void StanfordDiagram::add(const JudgedCycle& cycle) {
  if (latest_s_) {
    cycles_ += missing_cycles_s(*latest_s_, cycle.time_s).size();
  } else if (cycle.pose) {
    ++drives_with_pose_;
  } else {
    return;
  }
  latest_s_ = cycle.time_s;
  ++cycles_;
  if (cycle.pose) count(*cycle.pose);
}

void StanfordDiagram::count(const JudgedError& pose) {
  ++valid_;
  protection_.add(pose);
  for (int i = 0; i < 3; ++i) {
    const double error = std::abs(pose.error(i));
    const double level = pose.protection(i);
    if (!std::isfinite(level)) continue;
    const double limit = kFreewayAlertLimits(i);
    Axis& axis = axes_[static_cast<size_t>(i)];
    ++axis.counts[static_cast<size_t>(bin_of(level, limit) * kBins + bin_of(error, limit))];
    axis.worst_excess = std::max(axis.worst_excess, error - level);
  }
}

std::string to_table(const std::vector<NamedDiagram>& diagrams) {
  std::string text =
      "| drives | axis | valid poses | misleading | hazardous | protection level under the alert "
      "limit |\n|---|---|---:|---:|---:|---:|\n";
  for (const NamedDiagram& named : diagrams) {
    const ProtectionCounts& protection = named.diagram.protection();
    for (size_t i = 0; i < kAxisNames.size(); ++i) {
      const uint64_t misleading = protection.misleading[i];
      const uint64_t hazardous = protection.hazardous[i];
      const uint64_t with_level = protection.with_level[i];
      text += fmt::format("| {} | {} | {} | {} ({:.1e}) | {} ({:.1e}) | {:.1f} % |\n", named.name,
                          kAxisNames[i], named.diagram.valid(), misleading,
                          share(misleading, with_level), hazardous, share(hazardous, with_level),
                          100.0 * share(protection.available[i], named.diagram.cycles()));
    }
  }
  text += '\n';
  for (const NamedDiagram& named : diagrams) {
    text += fmt::format("{}: {} of {} drives had a pose\n", named.name,
                        named.diagram.drives_with_pose(), named.diagram.drives());
  }
  return text;
}

std::string to_json(const std::vector<NamedDiagram>& diagrams) {
  nlohmann::json array = nlohmann::json::array();
  for (const NamedDiagram& named : diagrams) {
    nlohmann::json object;
    object["name"] = named.name;
    object["drives"] = named.diagram.drives();
    object["drives_with_pose"] = named.diagram.drives_with_pose();
    object["cycles"] = named.diagram.cycles();
    object["valid_poses"] = named.diagram.valid();
    for (int i = 0; i < 3; ++i) object["axes"].push_back(json_of_axis(named.diagram, i));
    array.push_back(std::move(object));
  }
  return dump_json(array) + "\n";
}

}  // namespace bevloc::evaluation
