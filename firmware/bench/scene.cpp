#include "firmware/bench/scene.h"

#include "firmware/simulation/configured_world.h"
#include "pipeline/calibration/rig_yaml.h"
#include "sim/random.h"
#include "sim/render/renderer.h"
#include "sim/samples/sample_maker.h"
#include "sim/vehicle/placement.h"

namespace bevloc::bench {
namespace {

constexpr double kPeriod_s = 0.1;

}  // namespace

double Scene::pictures_mib() const {
  double bytes = 0.0;
  for (const Place& place : places) {
    for (const Pictures& pictures : place.framesets) {
      for (const RgbImage& picture : pictures) bytes += static_cast<double>(picture.pixels.size());
    }
  }
  return bytes / (1 << 20);
}

Result<SceneDrawer> SceneDrawer::create(const firmware::Config& config) {
  const auto rig = read_rig(config.rig_file);
  if (!rig) return tl::unexpected(rig.error());
  const firmware::SimulationConfig simulation =
      config.simulation.value_or(firmware::SimulationConfig());
  auto world = firmware::make_configured_world(config.map, simulation.seed);
  if (!world) return tl::unexpected(world.error());
  return SceneDrawer(*rig, std::move(*world), simulation.conditions);
}

SceneDrawer::SceneDrawer(const Rig& rig, sim::World world, const sim::Conditions& conditions)
    : rig_(rig), world_(std::move(world)), conditions_(conditions) {}

Place SceneDrawer::draw(int number, int framesets) const {
  const uint64_t seed = sim::kEvaluationSampleSeedBase + static_cast<uint64_t>(number);
  sim::Random random(sim::seed_for(seed, "bench place"));
  Place place;
  place.map_from_vehicle = sim::random_pose_on_road(world_, random);
  sim::Renderer renderer(world_);
  place.framesets.resize(static_cast<size_t>(framesets));
  double time_s = 0.0;
  for (Pictures& pictures : place.framesets) {
    for (size_t camera = 0; camera < pictures.size(); ++camera) {
      renderer.render(rig_.cameras[camera], place.map_from_vehicle, {}, time_s, conditions_,
                      random.bits(), pictures[camera]);
    }
    time_s += kPeriod_s;
  }
  return place;
}

Result<Scene> make_scene(const firmware::Config& config, int places, int framesets) {
  const auto drawer = SceneDrawer::create(config);
  if (!drawer) return tl::unexpected(drawer.error());
  Scene scene{drawer->rig(), drawer->map(), {}};
  for (int i = 0; i < places; ++i) scene.places.push_back(drawer->draw(i, framesets));
  return scene;
}

}  // namespace bevloc::bench
