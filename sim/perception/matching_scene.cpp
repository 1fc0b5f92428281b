#include "sim/perception/matching_scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "pipeline/map/rasterizer.h"
#include "sim/random.h"
#include "sim/vehicle/placement.h"

namespace bevloc::sim {
namespace {

// Scenes that share towns, and how many of one kind a town gives at most.
constexpr uint64_t kPlacesPerKind = 8;
constexpr uint64_t kScenesPerGroup = kPlacesPerKind * kRoadKinds;
constexpr size_t kPlacesPerTown = 4;
constexpr uint64_t kMostTownsPerGroup = 1024;
constexpr int kCandidatesPerTown = 200;

// Two scenes of a town are at least this far apart, or turned this much.
constexpr double kApart_m = 15.0;
constexpr double kApart_rad = radians(60.0);

bool is_apart(const Se2& a, const Se2& b) {
  return (a.translation() - b.translation()).norm() > kApart_m ||
         std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) > kApart_rad;
}

}  // namespace

/// A town without its scenery.
struct SceneSampler::Town {
  explicit Town(World&& generated) : world(std::move(generated)), index(world.map) {}

  World world;
  MapIndex index;
};

SceneSampler::SceneSampler(uint64_t seed_base, const HypothesisGrid& deviations)
    : seed_base_(seed_base), deviations_(deviations) {}

SceneSampler::~SceneSampler() = default;

/// Goes on to further towns until every kind of road has its places.
void SceneSampler::load_group(uint64_t group) {
  assert((group + 1) * kMostTownsPerGroup <= kSceneSeedCount);
  group_ = group;
  towns_.clear();
  for (std::vector<Place>& places : places_) places.clear();
  const auto is_full = [](const std::vector<Place>& places) {
    return places.size() >= kPlacesPerKind;
  };
  while (!std::all_of(places_.begin(), places_.end(), is_full)) {
    assert(towns_.size() < kMostTownsPerGroup);
    const uint64_t seed = seed_base_ + group * kMostTownsPerGroup + towns_.size();
    towns_.push_back(std::make_unique<const Town>(generate_world(seed)));
    collect_places(*towns_.back());
  }
}

void SceneSampler::collect_places(const Town& town) {
  Random random(seed_for(town.world.seed, "scenes"));
  std::array<size_t, kRoadKinds> taken{};
  std::vector<Se2> poses;
  for (int candidate = 0; candidate < kCandidatesPerTown; ++candidate) {
    const Se2 pose = random_pose_on_road(town.world, random);
    const auto kind = road_kind(town.index, pose);
    if (!kind) continue;
    const auto k = static_cast<size_t>(*kind);
    const bool wanted = taken[k] < kPlacesPerTown && places_[k].size() < kPlacesPerKind;
    if (!wanted || !std::all_of(poses.begin(), poses.end(),
                                [&pose](const Se2& other) { return is_apart(pose, other); })) {
      continue;
    }
    ++taken[k];
    poses.push_back(pose);
    places_[k].push_back({&town, pose});
  }
}

void SceneSampler::make(uint64_t number, CorruptionLevel level, MatchingScene& scene) {
  if (number / kScenesPerGroup != group_) load_group(number / kScenesPerGroup);
  const uint64_t in_group = number % kScenesPerGroup;
  const Place& place = places_[in_group % kRoadKinds][in_group / kRoadKinds];
  const uint64_t seed = mix_seed(seed_for(seed_base_, "scene") + number);
  Random random(seed_for(seed, "prior"));
  const auto within = [&random](const HypothesisAxis& axis) {
    return random.uniform(-axis.range, axis.range);
  };
  scene.kind = static_cast<RoadKind>(in_group % kRoadKinds);
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
  draw_perceived(visible_lines(place.town->index, place.map_from_vehicle, kPerceptionMargin_m),
                 level, seed_for(seed, "perception"), scene.perceived);
}

}  // namespace bevloc::sim
