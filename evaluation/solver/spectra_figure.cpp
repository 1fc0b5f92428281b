#include "evaluation/solver/spectra_figure.h"

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "evaluation/solver/figure_json.h"
#include "evaluation/solver/hand_made_features.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/solver/reference/amplitude_spectrum.h"
#include "pipeline/solver/reference/yaw_spectrum.h"
#include "sim/perception/matching_scene.h"
#include "sim/vehicle/placement.h"

namespace bevloc::evaluation {
namespace {

constexpr double kTurn_deg = 10.0;
constexpr double kSpectraShift_m = 5.0;
constexpr std::array<Se2, 3> kCorrections{
    {{}, {0.0, 0.0, radians(kTurn_deg)}, {kSpectraShift_m, kSpectraShift_m, radians(kTurn_deg)}}};

/// The masks and their union. The figure shows the union.
constexpr int kSpectraChannels = 4;
constexpr int kUnion = 3;
constexpr int kBand = 2;
constexpr int kSpectrumSize = 128;
/// The yaw range of the score's plot.
const HypothesisGrid kSpectraHypotheses{.yaw_rad = {radians(15.0), radians(0.5)}};

/// The first junction among random poses.
std::optional<Se2> find_junction(const sim::World& world, const MapIndex& index) {
  constexpr int kTries = 1000;
  sim::Random random(sim::seed_for(world.seed, "figure"));
  for (int i = 0; i < kTries; ++i) {
    const Se2 pose = sim::random_pose_on_road(world, random);
    if (sim::road_kind(index, pose) == sim::RoadKind::kJunction) return pose;
  }
  return std::nullopt;
}

/// The union's log(1 + amplitude), frequency 0 in the middle.
nlohmann::json log_amplitude(const CellFeatures& cells) {
  AmplitudeSpectrum spectrum(kFeatureGrid, kSpectraChannels, kSpectrumSize, kSpectrumSize,
                             Window::kHann, kSpectrumSize);
  spectrum.compute(cells, cells);
  const auto amplitude = spectrum.amplitude(0);
  std::vector<float> values;
  for (int u = -kSpectrumSize / 2; u < kSpectrumSize / 2; ++u) {
    for (int v = -kSpectrumSize / 2; v < kSpectrumSize / 2; ++v) {
      // Half of the columns are stored. The others are their point reflection.
      const int offset = v < 0 ? spectrum.offset(-u, -v) : spectrum.offset(u, v);
      values.push_back(std::log1p(amplitude[offset + kUnion]));
    }
  }
  return plane_json(values, kSpectrumSize, kSpectrumSize);
}

std::vector<double> signature_of_map(const YawSpectrum& spectrum) {
  const auto signature = spectrum.map_signature(kBand);
  std::vector<double> values;
  for (int i = 0; i < YawSpectrum::kAngles; ++i) {
    values.push_back(signature[static_cast<size_t>(i) * spectrum.lanes() + kUnion]);
  }
  return values;
}

nlohmann::json axes_json() {
  nlohmann::json json{{"turn_deg", kTurn_deg},
                      {"shift_m", kSpectraShift_m},
                      {"band", kBand},
                      {"frequency_limit_per_m", 0.5 / kFeatureGrid.cell_m}};
  constexpr double kBandWidth =
      (YawSpectrum::kMaxFrequency - YawSpectrum::kMinFrequency) / YawSpectrum::kBands;
  for (int edge = 0; edge <= YawSpectrum::kBands; ++edge) {
    json["band_edges_per_m"].push_back(YawSpectrum::kMinFrequency + edge * kBandWidth);
  }
  for (int i = 0; i < YawSpectrum::kAngles; ++i) {
    json["angles_deg"].push_back(180.0 * i / YawSpectrum::kAngles);
  }
  for (int i = 0; i < kSpectraHypotheses.yaw_rad.count(); ++i) {
    json["hypotheses_deg"].push_back(degrees(kSpectraHypotheses.yaw_rad.value(i)));
  }
  return json;
}

}  // namespace

Result<nlohmann::json> spectra_figure(uint64_t town) {
  const sim::World world = sim::generate_world(sim::kEvaluationSeedBase + town);
  const MapIndex index(world.map);
  const std::optional<Se2> pose = find_junction(world, index);
  if (!pose) return fail("scene {}: found no junction in its town, wanted one to show", town);

  nlohmann::json json = axes_json();
  MapRasterizer rasterizer(index);
  YawSpectrum spectrum(kFeatureGrid, kSpectraChannels, kSpectraHypotheses.yaw_rad);
  std::vector<double> score(static_cast<size_t>(kSpectraHypotheses.yaw_rad.count()));
  std::optional<CellFeatures> first;
  for (const Se2& correction : kCorrections) {
    std::vector<uint8_t> raster(kRasterSize);
    rasterizer.draw(*pose * correction.inverse(), raster);
    const CellFeatures cells = standardised_cells(features_of(raster, kSpectraChannels),
                                                  kSpectraChannels, kSpectraHypotheses);
    if (!first) first = cells;
    spectrum.score(*first, cells, score);
    json["views"].push_back({{"raster", bytes_json(raster)},
                             {"log_amplitude", log_amplitude(cells)},
                             {"signature", signature_of_map(spectrum)},
                             {"score", score}});
  }
  return json;
}

}  // namespace bevloc::evaluation
