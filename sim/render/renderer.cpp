#include "sim/render/renderer.h"

#include <tuple>
#include <utility>

#include "sim/render/ground_light.h"
#include "sim/render/ground_pass.h"
#include "sim/render/ground_window.h"
#include "sim/render/lighting.h"
#include "sim/render/panel.h"
#include "sim/render/panel_pass.h"
#include "sim/render/sensor_pass.h"
#include "sim/render/sky.h"
#include "sim/render/surroundings.h"
#include "sim/render/view.h"

namespace bevloc::sim {
namespace {

constexpr double kSightM = 160.0;  ///< farther objects are not drawn

}  // namespace

struct Renderer::Impl {
  /// The inputs of the surroundings and of the light on the ground. Cameras at the same moment
  /// share both.
  struct Moment {
    Se2 map_from_vehicle;
    double time_s = 0.0;
    Conditions conditions;

    auto key() const {
      return std::tie(map_from_vehicle.x_m, map_from_vehicle.y_m, map_from_vehicle.yaw_rad, time_s,
                      conditions.sun_azimuth_rad, conditions.sun_elevation_rad, conditions.overcast,
                      conditions.rain, conditions.exposure);
    }
  };

  explicit Impl(std::shared_ptr<GroundTiles> tiles)
      : ground(std::move(tiles)), scene(ground.world()), sky(ground.world().seed) {}

  /// Recomputes surroundings and ground light if the moment changes.
  void enter(const Moment& next, const Lighting& lighting) {
    if (moment_known && moment.key() == next.key()) return;
    moment = next;
    moment_known = true;
    scene.gather(moment.map_from_vehicle, moment.time_s, kSightM, surroundings);
    light.build(moment.map_from_vehicle.translation(), surroundings, lighting);
  }

  GroundWindow ground;
  SceneIndex scene;
  Sky sky;
  RayCache rays;
  Moment moment;
  bool moment_known = false;
  Surroundings surroundings;
  GroundLight light;
  PanelBuilder panels;
  LinearImage linear;
};

Renderer::Renderer(const World& world) : Renderer(std::make_shared<GroundTiles>(world)) {}

Renderer::Renderer(std::shared_ptr<GroundTiles> ground)
    : impl_(std::make_unique<Impl>(std::move(ground))) {}

Renderer::~Renderer() = default;

void Renderer::render(const MountedCamera& camera, const Se2& map_from_vehicle,
                      const Stance& stance, double time_s, const Conditions& conditions,
                      uint64_t noise_seed, RgbImage& image) {
  Impl& impl = *impl_;
  const Lighting lighting = lighting_of(conditions);
  impl.enter({map_from_vehicle, time_s, conditions}, lighting);
  const View view = make_view(impl.rays.rays_of(camera.now.intrinsics),
                              camera.now.vehicle_from_camera, map_from_vehicle, stance);
  impl.linear.resize(view.width(), view.height());
  impl.ground.open(view.position.head<2>());
  draw_ground_and_sky(view, lighting, impl.light, impl.sky, impl.ground, impl.linear);
  impl.ground.close();
  draw_panels(view, lighting, impl.panels.build(view.position, view.ground, impl.surroundings),
              impl.linear);
  develop(view, lighting, sensor_of(impl.ground.world().seed, camera.built_in), noise_seed,
          impl.linear, image);
}

}  // namespace bevloc::sim
