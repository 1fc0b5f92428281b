#include "drivers/mock/mock_scene.h"

#include <utility>

#include "pipeline/calibration/rig.h"
#include "sim/random.h"

namespace bevloc::drivers {

MockScene::MockScene(std::shared_ptr<const sim::World> world,
                     std::shared_ptr<const sim::Drive> drive, const sim::Conditions& conditions,
                     uint64_t noise_seed)
    : MockScene(world, std::move(drive), conditions, noise_seed,
                std::make_shared<sim::GroundTiles>(*world)) {}

MockScene::MockScene(std::shared_ptr<const sim::World> world,
                     std::shared_ptr<const sim::Drive> drive, const sim::Conditions& conditions,
                     uint64_t noise_seed, const std::shared_ptr<sim::GroundTiles>& ground)
    : world_(std::move(world)),
      drive_(std::move(drive)),
      conditions_(conditions),
      noise_seed_(noise_seed),
      renderers_{RendererSlot(ground), RendererSlot(ground)} {}

void MockScene::draw(int camera, const CameraModel& true_camera, Duration drive_time,
                     RgbImage& image) {
  const double time_s = to_seconds(drive_time);
  const uint64_t camera_seed = sim::seed_for(noise_seed_, kCameraNames[camera]);
  const uint64_t image_seed =
      sim::mix_seed(camera_seed ^ static_cast<uint64_t>(drive_time.count()));
  RendererSlot& slot = renderers_[static_cast<size_t>(camera) * renderers_.size() / kCameraCount];
  const std::lock_guard lock(slot.mutex);
  slot.renderer.render(true_camera, drive_->at(time_s).map_from_vehicle, drive_->body_at(time_s),
                       time_s, conditions_, image_seed, image);
}

}  // namespace bevloc::drivers
