#include "evaluation/solver/solver_figures.h"

#include <array>

#include <nlohmann/json.hpp>

#include "common/files.h"
#include "common/json_dump.h"
#include "evaluation/solver/axis_figure.h"
#include "evaluation/solver/distribution_figure.h"
#include "evaluation/solver/spectra_figure.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

constexpr std::array kRoads{sim::RoadKind::kJunction, sim::RoadKind::kStraightStructured,
                            sim::RoadKind::kStraightSolid};

/// One scene of each road in kRoads, in that order.
std::array<sim::MatchingScene, kRoads.size()> make_scenes(uint64_t number) {
  sim::SceneSampler sampler(sim::kEvaluationSeedBase);
  std::array<sim::MatchingScene, kRoads.size()> scenes;
  for (size_t i = 0; i < kRoads.size(); ++i) {
    sampler.make(number * sim::kRoadKinds + static_cast<uint64_t>(kRoads[i]),
                 sim::CorruptionLevel::kPaper, scenes[i]);
  }
  return scenes;
}

}  // namespace

Status write_solver_figures(uint64_t scene, const std::string& file) {
  auto spectra = spectra_figure(scene);
  if (!spectra) return tl::unexpected(spectra.error());
  const auto scenes = make_scenes(scene);
  auto distributions = distribution_figure(scenes);
  if (!distributions) return tl::unexpected(distributions.error());
  const nlohmann::json json{{"scene", scene},
                            {"spectra", std::move(*spectra)},
                            {"axis_features", axis_figure(scenes.front())},
                            {"distributions", std::move(*distributions)}};
  return write_file(file, dump_json(json) + "\n");
}

}  // namespace bevloc::evaluation
