// Scenes on which pose solvers are judged without a network: a perceived mask, and the map drawn
// where the prior pose puts it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/se2.h"
#include "pipeline/map/map_index.h"
#include "pipeline/solver/solver.h"
#include "sim/perception/corruption.h"
#include "sim/perception/road_kind.h"
#include "sim/world/world_generator.h"

namespace bevloc::sim {

/// Town seeds of the scenes: 2^30 for tuning, 2^30 for evaluation, below training's and above the
/// small ones that demos and tests use.
inline constexpr uint64_t kSceneSeedCount = 1ULL << 30U;
inline constexpr uint64_t kTuningSeedBase = 2 * kSceneSeedCount;
inline constexpr uint64_t kEvaluationSeedBase = 3 * kSceneSeedCount;
static_assert(kTuningSeedBase + kSceneSeedCount <= kEvaluationSeedBase);
static_assert(kEvaluationSeedBase + kSceneSeedCount <= kFirstTrainingSeed);

struct MatchingScene {
  RoadKind kind = RoadKind::kStraightSolid;
  bool surveyed = false;              ///< the map holds every dash (surveyed_map.h)
  Se2 map_from_vehicle;               ///< the true pose T
  Se2 correction;                     ///< dT = T0^-1 T, what a solver should find
  std::vector<uint8_t> raster_prior;  ///< the map at T0, kRasterSize bytes
  std::vector<uint8_t> raster_truth;  ///< the map at T
  std::vector<float> perceived;       ///< what is seen at T, kRasterSize probabilities
};

/// An endless stream of scenes; everything about scene i follows from the seed base, the range and
/// i. Scene i shows a road of kind i % kRoadKinds; the maps draw dashed dividers as continuous
/// lines and dash by dash in turn, kRoadKinds scenes each. Fastest when asked for scenes in order:
/// forty in a row share their towns. Not thread safe.
class SceneSampler {
 public:
  /// `seed_base` is kEvaluationSeedBase or kTuningSeedBase. Corrections are uniform within the
  /// ranges of `deviations`; its steps are not used.
  explicit SceneSampler(uint64_t seed_base, const HypothesisGrid& deviations = {});
  ~SceneSampler();

  /// Overwrites `scene`. The level changes nothing but `perceived`.
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
  std::array<PlacesByKind, 2> places_;  ///< in towns with a plain map, with a surveyed one
};

}  // namespace bevloc::sim
