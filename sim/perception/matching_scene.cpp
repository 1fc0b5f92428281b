#include "sim/perception/matching_scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "pipeline/map/rasterizer.h"
#include "sim/perception/surveyed_map.h"
#include "sim/random.h"
#include "sim/vehicle/placement.h"

namespace bevloc::sim {
namespace {

constexpr uint64_t kPlacesPerKind = 4;  ///< places of a group, per kind of road and kind of map
static_assert(kScenesPerGroup == 2 * kPlacesPerKind * kRoadKinds);
constexpr size_t kPlacesPerTown = 2;  ///< most places of one kind of road
constexpr int kCandidatesPerTown = 200;

/// Every other town has a surveyed map.
bool is_surveyed(uint64_t seed) {
  return seed % 2 == 1;
}

}  // namespace

/// A town with its maps.
struct SceneSampler::Town {
  explicit Town(uint64_t seed)
      : surveyed(is_surveyed(seed)),
        world(generate_world(seed)),
        dashes(surveyed ? painted_dashes(world) : MapDashes{}),
        map(surveyed_map(world.map, dashes)),
        continuous_index(world.map),
        index(map) {}

  bool surveyed;
  World world;
  MapDashes dashes;
  HdMap map;                  ///< map, with one element per dash if surveyed
  MapIndex continuous_index;  ///< index of the world's map, where dashed dividers are continuous
  MapIndex index;             ///< index of `map`
};

SceneSampler::SceneSampler(uint64_t seed_base, const HypothesisGrid& deviations)
    : seed_base_(seed_base), deviations_(deviations) {}

SceneSampler::~SceneSampler() = default;

/// Loads towns until there are enough places for every kind of road on both kinds of map.
void SceneSampler::load_group(uint64_t group) {
  assert((group + 1) * kTownsPerGroup <= kSceneSeedCount);
  group_ = group;
  towns_.clear();
  places_ = {};
  const uint64_t first_seed = seed_base_ + group * kTownsPerGroup;
  for (uint64_t town = 0; !is_full(places_[0]) || !is_full(places_[1]); ++town) {
    assert(town < kTownsPerGroup);
    const uint64_t seed = first_seed + town;
    PlacesByKind& places = places_[is_surveyed(seed) ? 1 : 0];
    if (is_full(places)) continue;
    towns_.push_back(std::make_unique<const Town>(seed));
    collect_places(*towns_.back(), places);
  }
}

bool SceneSampler::is_full(const PlacesByKind& places) {
  return std::all_of(places.begin(), places.end(), [](const std::vector<Place>& of_kind) {
    return of_kind.size() >= kPlacesPerKind;
  });
}

void SceneSampler::collect_places(const Town& town, PlacesByKind& places) {
  Random random(seed_for(town.world.seed, "scenes"));
  std::array<size_t, kRoadKinds> taken{};
  std::vector<Se2> poses;
  for (int candidate = 0; candidate < kCandidatesPerTown; ++candidate) {
    const Se2 pose = random_pose_on_road(town.world, random);
    const auto kind = road_kind(town.continuous_index, pose, town.dashes);
    if (!kind) continue;
    const auto k = static_cast<size_t>(*kind);
    const bool wanted = taken[k] < kPlacesPerTown && places[k].size() < kPlacesPerKind;
    if (!wanted || !is_apart(pose, poses)) continue;
    ++taken[k];
    poses.push_back(pose);
    places[k].push_back({&town, pose});
  }
}

void SceneSampler::make(uint64_t number, CorruptionLevel level, MatchingScene& scene) {
  if (number / kScenesPerGroup != group_) load_group(number / kScenesPerGroup);
  const uint64_t in_group = number % kScenesPerGroup;
  const uint64_t kind = in_group % kRoadKinds;
  const uint64_t turn = in_group / kRoadKinds;
  const Place& place = places_[turn % 2][kind][turn / 2];
  const uint64_t seed = mix_seed(seed_for(seed_base_, "scene") + number);
  Random random(seed_for(seed, "prior"));
  const auto within = [&random](const HypothesisAxis& axis) {
    return random.uniform(-axis.range, axis.range);
  };
  scene.kind = static_cast<RoadKind>(kind);
  scene.surveyed = place.town->surveyed;
  scene.map_from_vehicle = place.map_from_vehicle;
  scene.correction.x_m = within(deviations_.x_m);
  scene.correction.y_m = within(deviations_.y_m);
  scene.correction.yaw_rad = within(deviations_.yaw_rad);

  MapRasterizer rasterizer(place.town->index);
  scene.raster_truth.resize(kRasterSize);
  rasterizer.draw(place.map_from_vehicle, scene.raster_truth);
  scene.raster_prior.resize(kRasterSize);
  rasterizer.draw(place.map_from_vehicle * scene.correction.inverse(), scene.raster_prior);
  scene.perceived.resize(kRasterSize);
  const std::vector<VisibleLine> lines =
      visible_lines(place.town->continuous_index, place.map_from_vehicle, kPerceptionMargin_m,
                    place.town->dashes);
  draw_perceived(lines, level, seed_for(seed, "perception"), scene.perceived);
}

}  // namespace bevloc::sim
