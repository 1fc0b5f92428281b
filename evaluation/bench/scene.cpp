#include "evaluation/bench/scene.h"

#include "evaluation/drive/configured_world.h"
#include "pipeline/calibration/rig_yaml.h"
#include "sim/random.h"
#include "sim/render/renderer.h"
#include "sim/samples/sample_maker.h"
#include "sim/vehicle/placement.h"

namespace bevloc::bench {
namespace {

constexpr double kPeriod_s = 0.1;

}  // namespace

double Scene::images_mib() const {
  double bytes = 0.0;
  for (const Place& place : places) {
    for (const FramesetImages& images : place.framesets) {
      for (const RgbImage& image : images) bytes += static_cast<double>(image.pixels.size());
    }
  }
  return bytes / (1 << 20);
}

Result<SceneDrawer> SceneDrawer::create(const evaluation::DriveConfig& config) {
  const auto rig = read_rig(config.rig_file);
  if (!rig) return tl::unexpected(rig.error());
  auto world = evaluation::make_configured_world(config);
  if (!world) return tl::unexpected(world.error());
  return SceneDrawer(*rig, std::move(*world),
                     config.simulation ? config.simulation->conditions : sim::Conditions());
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
  for (FramesetImages& images : place.framesets) {
    for (size_t camera = 0; camera < images.size(); ++camera) {
      renderer.render(rig_.cameras[camera], place.map_from_vehicle, {}, time_s, conditions_,
                      random.bits(), images[camera]);
    }
    time_s += kPeriod_s;
  }
  return place;
}

Result<Scene> make_scene(const evaluation::DriveConfig& config, int places, int framesets) {
  const auto drawer = SceneDrawer::create(config);
  if (!drawer) return tl::unexpected(drawer.error());
  Scene scene{drawer->rig(), drawer->map(), {}};
  for (int i = 0; i < places; ++i) scene.places.push_back(drawer->draw(i, framesets));
  return scene;
}

}  // namespace bevloc::bench
