#include "firmware/live/live_events.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "common/base64.h"
#include "common/json_dump.h"
#include "pipeline/bev_grid.h"
#include "pipeline/localization/projected_map.h"

namespace bevloc::firmware {
namespace {

using nlohmann::json;

constexpr int kReduction = 2;  ///< cells of the mask per character

double rounded(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit;
}

/// Returns each line as [class, x, y, x, y, ...].
json lines_of(std::span<const ProjectedLine> lines, double steps_per_unit) {
  json list = json::array();
  for (const ProjectedLine& line : lines) {
    json numbers = json::array({static_cast<int>(line.element_class)});
    for (const Eigen::Vector2d& point : line.points) {
      numbers.push_back(rounded(point.x(), steps_per_unit));
      numbers.push_back(rounded(point.y(), steps_per_unit));
    }
    list.push_back(std::move(numbers));
  }
  return list;
}

Se2 corrected_pose(const LiveSample& sample) {
  return sample.prior * sample.match.correction;
}

json distribution_of(const HypothesisAxis& axis, const std::vector<float>& probability,
                     double unit) {
  json list = json::array();
  for (const float value : probability) list.push_back(rounded(value, 1e4));
  return {{"step", axis.step * unit}, {"probability", std::move(list)}};
}

/// Returns "event: NAME\ndata: JSON\n\n".
std::string server_sent_event(const char* name, const json& data) {
  return fmt::format("event: {}\ndata: {}\n\n", name, dump_json(data));
}

}  // namespace

std::string status_event(const Telemetry& telemetry, const ProcessUse& process, Duration age,
                         Duration sent) {
  json status = status_json(telemetry, process, age);
  status["sent_s"] = rounded(to_seconds(sent), 1e3);
  return server_sent_event("status", status);
}

std::string trail_event(const std::deque<TrailPoint>& trail) {
  json points = json::array();
  for (const TrailPoint& point : trail) {
    points.push_back({rounded(point.x_m, 100), rounded(point.y_m, 100), point.valid ? 1 : 0,
                      point.begins ? 1 : 0});
  }
  return server_sent_event("trail", points);
}

std::string map_event(const MapIndex& map, const Eigen::Vector2d& centre_m, double reach_m) {
  ProjectedMap projected(map);
  json lines = lines_of(projected.around({centre_m.x(), centre_m.y(), 0.0}, reach_m), 10);
  return server_sent_event("map", {{"name", map.map().name},
                                   {"x_m", centre_m.x()},
                                   {"y_m", centre_m.y()},
                                   {"lines", std::move(lines)}});
}

std::string mask_text(std::span<const float> logits) {
  constexpr float kQuarter = 1.0986123F;  // the logit of 3/4
  constexpr int kCols = kRasterGrid.cols;
  std::string text;
  text.reserve(static_cast<size_t>(kRasterGrid.cells()) / (kReduction * kReduction));
  for (int row = 0; row < kRasterGrid.rows; row += kReduction) {
    for (int col = 0; col < kCols; col += kReduction) {
      int value = 0;
      for (int channel = 0; channel < kRasterChannels; ++channel) {
        const float* const at = &logits[channel * kRasterGrid.cells() + row * kCols + col];
        const float highest = std::max({at[0], at[1], at[kCols], at[kCols + 1]});
        const int level = (highest >= -kQuarter) + (highest >= 0.0F) + (highest >= kQuarter);
        value |= level << (2 * channel);
      }
      text += static_cast<char>('0' + value);
    }
  }
  return text;
}

std::string match_event(const MapIndex& map, const LiveSample& sample) {
  ProjectedMap projected(map);
  const MatchResult& match = sample.match;
  const bool good = match.evidence == Evidence::kGood;
  const double reach_m = kRasterGrid.x_range_m();
  json data{
      {"evidence", good},
      {"score", match.score},
      {"mask", mask_text(sample.mask)},
      {"mask_cols", kRasterGrid.cols / kReduction},
      {"mask_cell_m", kRasterGrid.cell_m * kReduction},
      {"prior", lines_of(projected.around(sample.prior, reach_m), 20)},
      {"x", distribution_of(sample.hypotheses.x_m, sample.probabilities[0], 1.0)},
      {"y", distribution_of(sample.hypotheses.y_m, sample.probabilities[1], 1.0)},
      {"yaw", distribution_of(sample.hypotheses.yaw_rad, sample.probabilities[2], degrees(1.0))}};
  data["corrected"] =
      good ? lines_of(projected.around(corrected_pose(sample), reach_m), 20) : json(nullptr);
  data["correction"] = {match.correction.x_m, match.correction.y_m,
                        degrees(match.correction.yaw_rad)};
  return server_sent_event("match", data);
}

std::string camera_event(const MapIndex& map, const Rig& rig, const LiveSample& sample,
                         PictureMaker& pictures) {
  const auto jpeg = pictures.jpeg_of(sample.image);
  if (!jpeg) return {};
  const CameraModel& camera = rig.cameras[sample.camera];
  ProjectedMap projected(map);
  const auto lines_at = [&](const Se2& pose) {
    return lines_of(projected.in_image(pose * sample.reference_from_exposure, camera), 1);
  };
  json data{{"camera", kCameraNames[sample.camera]},
            {"width_px", sample.image.width},
            {"height_px", sample.image.height},
            {"used", static_cast<bool>(sample.present[sample.camera])},
            {"jpeg", base64(*jpeg)},
            {"prior", lines_at(sample.prior)}};
  data["corrected"] =
      sample.match.evidence == Evidence::kGood ? lines_at(corrected_pose(sample)) : json(nullptr);
  return server_sent_event("camera", data);
}

}  // namespace bevloc::firmware
