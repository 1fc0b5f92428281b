// Scenes to evaluate pose solvers without a network: a perceived mask and the map drawn at the
// prior.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/se2.h"
#include "pipeline/map/map_index.h"
#include "pipeline/solver/hypotheses.h"
#include "sim/perception/corruption.h"
#include "sim/perception/road_kind.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {

/// Town seeds of the scenes: 2^30 for tuning and 2^30 for evaluation. They lie above the small
/// seeds of demos and tests and below those of training.
inline constexpr uint64_t kSceneSeedCount = 1ULL << 30U;
inline constexpr uint64_t kTuningSeedBase = 2 * kSceneSeedCount;
inline constexpr uint64_t kEvaluationSeedBase = 3 * kSceneSeedCount;
static_assert(kTuningSeedBase + kSceneSeedCount <= kEvaluationSeedBase);
static_assert(kEvaluationSeedBase + kSceneSeedCount <= kFirstTrainingSeed);

/// Scenes come in groups that share their towns. A group has this many scenes and town seeds.
inline constexpr uint64_t kScenesPerGroup = 40;
inline constexpr uint64_t kTownsPerGroup = 1024;

/// The number of scenes that this many town seeds suffice for.
constexpr uint64_t scenes_of(uint64_t town_seeds) {
  return town_seeds / kTownsPerGroup * kScenesPerGroup;
}

struct MatchingScene {
  RoadKind kind = RoadKind::kStraightSolid;
  bool surveyed = false;              ///< the map has one element per dash (surveyed_map.h)
  Se2 map_from_vehicle;               ///< the true pose T
  Se2 correction;                     ///< dT = T0^-1 T, which a solver should find
  std::vector<uint8_t> raster_prior;  ///< the map at T0, kRasterSize bytes
  std::vector<uint8_t> raster_truth;  ///< the map at T
  std::vector<float> perceived;       ///< the perceived mask at T, kRasterSize probabilities
};

/// An endless stream of scenes. Scene i depends on the seed base, the deviations and i alone. Scene
/// i shows a road of kind i % kRoadKinds. In turn, kRoadKinds scenes have maps with continuous
/// dashed dividers and kRoadKinds scenes have surveyed maps with one element per dash. This is
/// fastest if scenes are made in order, because groups of them share their towns. One thread.
class SceneSampler {
 public:
  /// `seed_base` is kEvaluationSeedBase or kTuningSeedBase. Corrections are uniform within the
  /// ranges of `deviations`; its steps are ignored.
  explicit SceneSampler(uint64_t seed_base, const HypothesisGrid& deviations = {});
  ~SceneSampler();

  /// Makes scene `number` in `scene`. The level affects `perceived` alone.
  void make(uint64_t number, CorruptionLevel level, MatchingScene& scene);

 private:
  struct Town;
  struct Place {
    const Town* town;
    Se2 map_from_vehicle;
  };
  using PlacesByKind = std::array<std::vector<Place>, kRoadKinds>;

  void load_group(uint64_t group);
  static bool is_full(const PlacesByKind& places);
  static void collect_places(const Town& town, PlacesByKind& places);

  uint64_t seed_base_;
  HypothesisGrid deviations_;
  uint64_t group_ = ~0ULL;
  std::vector<std::unique_ptr<const Town>> towns_;
  std::array<PlacesByKind, 2> places_;  ///< [0]: towns with a plain map, [1]: with a surveyed map
};

}  // namespace bevloc::sim
