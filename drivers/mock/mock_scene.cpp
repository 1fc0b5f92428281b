#include "drivers/mock/mock_scene.h"

#include <utility>

#include "pipeline/calibration/rig.h"
#include "sim/digest.h"
#include "sim/random.h"
#include "sim/world/world_digest.h"

namespace bevloc::drivers {

namespace {

uint64_t digest_of_all(const sim::World& world, const sim::Conditions& conditions,
                       const MockStreet& street) {
  sim::Digest digest;
  digest.add(sim::digest_of(world));
  digest.add(street.digest);
  for (const double part :
       {conditions.sun_azimuth_rad, conditions.sun_elevation_rad, conditions.overcast,
        conditions.rain, conditions.exposure, conditions.noise_sigma}) {
    digest.add(part);
  }
  return digest.value();
}

void add(sim::Digest& digest, const CameraModel& camera) {
  const Intrinsics& lens = camera.intrinsics;
  digest.add(static_cast<int>(lens.lens));
  digest.add(lens.width_px);
  digest.add(lens.height_px);
  for (const double part : {lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, lens.k1, lens.k2,
                            lens.p1, lens.p2, lens.k3, lens.k4}) {
    digest.add(part);
  }
  for (const double part : camera.vehicle_from_camera.rotation.reshaped()) digest.add(part);
  for (const double part : camera.vehicle_from_camera.translation_m) digest.add(part);
}

}  // namespace

MockScene::MockScene(std::shared_ptr<const sim::World> world,
                     std::shared_ptr<const sim::Drive> drive, const sim::Conditions& conditions,
                     uint64_t noise_seed, std::shared_ptr<PictureCache> pictures,
                     const MockStreet& street)
    : MockScene(world, std::move(drive), conditions, noise_seed, std::move(pictures), street,
                std::make_shared<sim::GroundTiles>(*world)) {}

MockScene::MockScene(std::shared_ptr<const sim::World> world,
                     std::shared_ptr<const sim::Drive> drive, const sim::Conditions& conditions,
                     uint64_t noise_seed, std::shared_ptr<PictureCache> pictures,
                     const MockStreet& street, const std::shared_ptr<sim::GroundTiles>& ground)
    : world_(std::move(world)),
      drive_(std::move(drive)),
      conditions_(conditions),
      noise_seed_(noise_seed),
      street_(street),
      pictures_(std::move(pictures)),
      digest_(pictures_ ? digest_of_all(*world_, conditions_, street_) : 0),
      renderers_{RendererSlot(ground), RendererSlot(ground)} {}

uint64_t MockScene::key_of(const sim::MountedCamera& true_camera, const sim::Drive::State& state,
                           const sim::BodyMotion& body, Duration drive_time,
                           uint64_t image_seed) const {
  sim::Digest digest;
  digest.add(digest_);
  digest.add(drive_time.count());
  digest.add(image_seed);
  const Se2& pose = state.map_from_vehicle;
  for (const double part :
       {pose.x_m, pose.y_m, pose.yaw_rad, body.pitch_rad, body.roll_rad, body.lift_m}) {
    digest.add(part);
  }
  add(digest, true_camera.now);
  add(digest, true_camera.built_in);
  return digest.value();
}

void MockScene::draw(int camera, const sim::MountedCamera& true_camera, Duration drive_time,
                     RgbImage& image) {
  const double time_s = to_seconds(drive_time);
  const uint64_t camera_seed = sim::seed_for(noise_seed_, kCameraNames[camera]);
  const uint64_t image_seed =
      sim::mix_seed(camera_seed ^ static_cast<uint64_t>(drive_time.count()));
  const sim::Drive::State state = drive_->at(time_s);
  const sim::BodyMotion body = drive_->body_at(time_s);
  const uint64_t key = pictures_ ? key_of(true_camera, state, body, drive_time, image_seed) : 0;
  if (pictures_ && pictures_->find(key, image)) return;
  RendererSlot& slot = renderers_[static_cast<size_t>(camera) * renderers_.size() / kCameraCount];
  const sim::Stance stance{.body = body, .ground = drive_->ground_at(time_s, street_.slopes)};
  {
    const std::lock_guard lock(slot.mutex);
    slot.renderer.render(true_camera, state.map_from_vehicle, stance, time_s, conditions_,
                         image_seed, image);
  }
  if (street_.changes_pictures) sim::apply(street_.looks[static_cast<size_t>(camera)], image);
  if (pictures_) pictures_->keep(key, image);
}

}  // namespace bevloc::drivers
