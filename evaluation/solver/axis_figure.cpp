#include "evaluation/solver/axis_figure.h"

#include <array>
#include <numeric>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "evaluation/solver/figure_json.h"
#include "evaluation/solver/hand_made_features.h"
#include "pipeline/solver/feature_warp.h"
#include "pipeline/solver/reference/axis_matching.h"

namespace bevloc::evaluation {
namespace {

constexpr int kAxisChannels = 16;
constexpr double kAxisShift_m = 2.0;
const HypothesisGrid kAxisHypotheses{{3.0, 0.2}, {3.0, 0.2}, {radians(2.0), radians(0.2)}};

/// Three of the 16 channels of sim::MaskFeatures: each class, blurred by 0.3 m.
struct ShownChannel {
  const char* name;
  int channel;
};
constexpr std::array<ShownChannel, 3> kShownChannels{
    {{"divider", 0}, {"crossing", 5}, {"boundary", 10}}};

/// The features of one side, before and after standardisation.
struct Side {
  explicit Side(const std::vector<float>& features)
      : raw(kFeatureGrid, kAxisChannels, kAxisHypotheses),
        standardised(standardised_cells(features, kAxisChannels, kAxisHypotheses)) {
    raw.assign(features);
  }

  CellFeatures raw;
  CellFeatures standardised;
};

CellFeatures moved(const CellFeatures& features) {
  CellFeatures result(kFeatureGrid, kAxisChannels, kAxisHypotheses);
  const FeatureWarp warped(features, Se2{kAxisShift_m, kAxisShift_m, 0.0});
  for (int row = 0; row < kFeatureGrid.rows; ++row) {
    warp(warped.line(row, 0, kFeatureGrid.cols), result.mutable_cell(row, 0));
  }
  return result;
}

nlohmann::json shown_planes(const CellFeatures& raw) {
  std::vector<float> planes;
  for (const ShownChannel& shown : kShownChannels) {
    for (int row = 0; row < kFeatureGrid.rows; ++row) {
      for (int col = 0; col < kFeatureGrid.cols; ++col) {
        planes.push_back(raw.cell(row, col)[shown.channel]);
      }
    }
  }
  return planes_json(planes, kFeatureGrid);
}

/// The axis features of the shown channels inside the border, less their mean: [channel][position].
nlohmann::json profiles(std::span<const float> axis_features, int cells,
                        const AxisMatching& matching) {
  nlohmann::json result = nlohmann::json::array();
  for (const ShownChannel& shown : kShownChannels) {
    std::vector<double> values;
    for (int i = matching.crop(); i < cells - matching.crop(); ++i) {
      values.push_back(axis_features[static_cast<size_t>(i) * matching.lanes() + shown.channel]);
    }
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    for (double& value : values) value -= mean;
    result.push_back(values);
  }
  return result;
}

nlohmann::json side_json(const CellFeatures& raw, const AxisMatching::AxisFeatures& axes,
                         const AxisMatching& matching) {
  return {{"features", shown_planes(raw)},
          {"x_profile", profiles(axes.x, kFeatureGrid.rows, matching)},
          {"y_profile", profiles(axes.y, kFeatureGrid.cols, matching)}};
}

nlohmann::json perceived_json(const CellFeatures& raw, const AxisMatching& matching) {
  nlohmann::json json = side_json(raw, matching.bev(), matching);
  std::vector<double> scores(static_cast<size_t>(kAxisHypotheses.x_m.count()));
  matching.score_x(scores);
  json["x_score"] = scores;
  matching.score_y(scores);
  json["y_score"] = scores;
  return json;
}

/// The positions of the cells inside the border; `position_m` maps an index to its position.
template <typename Position>
std::vector<double> positions_m(int cells, int crop, Position position_m) {
  std::vector<double> positions;
  for (int i = crop; i < cells - crop; ++i) positions.push_back(position_m(i));
  return positions;
}

}  // namespace

nlohmann::json axis_figure(const sim::MatchingScene& scene) {
  const Side map(features_of(scene.raster_truth, kAxisChannels));
  const Side perceived(features_of(scene.perceived, kAxisChannels));
  AxisMatching matching(kFeatureGrid, kAxisChannels, kAxisHypotheses);
  matching.set_features(perceived.standardised, 0.0, map.standardised);

  nlohmann::json json{{"shift_m", kAxisShift_m}};
  for (const ShownChannel& shown : kShownChannels) json["channels"].push_back(shown.name);
  json["x_m"] = positions_m(kFeatureGrid.rows, matching.crop(),
                            [](int row) { return kFeatureGrid.x_of_row(row); });
  json["y_m"] = positions_m(kFeatureGrid.cols, matching.crop(),
                            [](int col) { return kFeatureGrid.y_of_col(col); });
  for (int i = 0; i < kAxisHypotheses.x_m.count(); ++i) {
    json["hypotheses_m"].push_back(kAxisHypotheses.x_m.value(i));
  }
  json["map"] = side_json(map.raw, matching.map(), matching);
  json["perceived"].push_back(perceived_json(perceived.raw, matching));
  matching.set_features(moved(perceived.standardised), 0.0, map.standardised);
  json["perceived"].push_back(perceived_json(moved(perceived.raw), matching));
  return json;
}

}  // namespace bevloc::evaluation
