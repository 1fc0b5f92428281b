#include "firmware/evaluation/solver_figures.h"

#include <array>
#include <filesystem>
#include <system_error>

#include "firmware/evaluation/axis_figure.h"
#include "firmware/evaluation/distribution_figure.h"
#include "firmware/evaluation/spectra_figure.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

constexpr std::array kRoads{sim::RoadKind::kJunction, sim::RoadKind::kStraightStructured,
                            sim::RoadKind::kStraightSolid};

/// One scene of each of kRoads, in this order.
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

Status draw_solver_figures(uint64_t scene, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail("{}: the folder cannot be made: {}", folder, error.message());
  const std::string prefix = (std::filesystem::path(folder) / "solver_").string();
  if (Status status = draw_spectra(scene, prefix + "spectra.png"); !status) return status;
  const auto scenes = make_scenes(scene);
  if (Status status = draw_axis_features(scenes.front(), prefix + "axis_features.png"); !status) {
    return status;
  }
  return draw_distributions(scenes, prefix + "distributions.png");
}

}  // namespace bevloc::evaluation
