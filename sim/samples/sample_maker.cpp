#include "sim/samples/sample_maker.h"

#include <cmath>

#include "pipeline/map/map_index.h"
#include "pipeline/map/rasterizer.h"
#include "sim/render/conditions.h"
#include "sim/render/renderer.h"
#include "sim/samples/camera_looks.h"
#include "sim/samples/map_habits.h"
#include "sim/samples/passage.h"
#include "sim/samples/random_rig.h"
#include "sim/samples/world_changes.h"
#include "sim/sim_rig.h"
#include "sim/vehicle/placement.h"

namespace bevloc::sim {
namespace {

// The correction of the prior is uniform within these limits.
constexpr double kMaxLongitudinalM = 2.0;
constexpr double kMaxLateralM = 1.0;
constexpr double kMaxYawRad = radians(2.0);

// The time of the traffic is drawn from 0 to this.
constexpr double kTrafficTimeS = 600.0;

// Attempts to find a pose that differs from the world's other poses.
constexpr int kPoseTries = 20;

uint64_t sample_seed(const SampleStream& stream, uint64_t sample) {
  return mix_seed(seed_for(stream.first_seed, "sample") + sample);
}

/// Draws the poses of all samples of a world. All are drawn even if a stream resumes in the middle,
/// because each pose depends on the ones before it.
std::vector<Se2> poses_in(const World& world, uint64_t world_seed) {
  std::vector<Se2> poses;
  Random random(seed_for(world_seed, "poses"));
  while (poses.size() < kSamplesPerWorld) {
    Se2 pose;
    for (int attempt = 0; attempt < kPoseTries; ++attempt) {
      pose = random_pose_on_road(world, random);
      if (is_apart(pose, poses)) break;
    }
    poses.push_back(pose);
  }
  return poses;
}

Eigen::Vector3d random_vector(double sigma, Random& random) {
  Eigen::Vector3d vector;
  for (double& component : vector) component = random.normal(0.0, sigma);
  return vector;
}

/// The camera that really takes the images: the calibrated network camera with a random calibration
/// error. The crop stays where the calibration puts it, so an error in pitch moves the horizon.
CameraModel true_camera(const CameraModel& calibrated, const CalibrationSigma& sigma,
                        Random& random) {
  CameraModel camera = calibrated;
  camera.vehicle_from_camera.rotation *= rotation_by(random_vector(sigma.rotation_rad, random));
  camera.vehicle_from_camera.translation_m += random_vector(sigma.position_m, random);
  const double focal_factor = random.normal(1.0, sigma.relative_focal);
  camera.intrinsics.fx_px *= focal_factor;
  camera.intrinsics.fy_px *= focal_factor;
  return camera;
}

Conditions conditions_for(Weather weather, uint64_t seed) {
  Conditions conditions = random_conditions(seed_for(seed, "conditions"));
  Random random(seed_for(seed, "weather"));
  switch (weather) {
    case Weather::kUsual:
      break;
    case Weather::kClearNoon:
      return {.sun_azimuth_rad = conditions.sun_azimuth_rad,
              .sun_elevation_rad = radians(60.0),
              .overcast = 0.0,
              .rain = 0.0,
              .exposure = 1.0,
              .noise_sigma = 1.0};
    case Weather::kNight:
      conditions.sun_elevation_rad = random_night_elevation_rad(random);
      break;
    case Weather::kRain:
      add_rain(random, conditions);
      break;
  }
  return conditions;
}

GroundShape random_ground(const Slopes& slopes, uint64_t seed) {
  Random random(seed_for(seed, "ground"));
  const auto within = [&random](double limit) { return random.uniform(-limit, limit); };
  return {within(slopes.along_per_m), within(slopes.across_per_m), within(slopes.twist_per_m)};
}

/// Converts interleaved colours to planes.
void copy_as_planes(const RgbImage& image, uint8_t* planes) {
  const size_t count = static_cast<size_t>(image.width) * image.height;
  for (size_t i = 0; i < count; ++i) {
    for (size_t colour = 0; colour < 3; ++colour) {
      planes[colour * count + i] = image.pixels[3 * i + colour];
    }
  }
}

/// Makes the pixels black that the real cameras do not show, because the daemon does not see them
/// either.
void blacken_unseen(const Rig& real, Sample& sample) {
  constexpr size_t kPixels = kImagesSize / kCameraCount / 3;
  for (size_t camera = 0; camera < kCameraCount; ++camera) {
    const Intrinsics& network = sample.rig.cameras[camera].intrinsics;
    uint8_t* planes = sample.images.data() + camera * 3 * kPixels;
    for (size_t i = 0; i < kPixels; ++i) {
      const Eigen::Vector2d pixel(static_cast<double>(i % kNetworkWidthPx),
                                  static_cast<double>(i / kNetworkWidthPx));
      if (shown_place(real.cameras[camera], network, pixel)) continue;
      for (size_t colour = 0; colour < 3; ++colour) planes[colour * kPixels + i] = 0;
    }
  }
}

/// Renders the images of the sample's cameras (black for missing ones) and sets their motions.
void take_images(Renderer& renderer, const Se2& map_from_vehicle, const Nuisances& nuisances,
                 uint64_t seed, Sample& sample) {
  Random random(seed_for(seed, "body and cameras"));
  const BodyMotion body{.pitch_rad = random.normal(0.0, nuisances.body.tilt_rad),
                        .roll_rad = random.normal(0.0, nuisances.body.tilt_rad),
                        .lift_m = random.normal(0.0, nuisances.body.lift_m)};
  const Stance stance{.body = body, .ground = random_ground(nuisances.slopes, seed)};
  const double time_s = random.uniform(0.0, kTrafficTimeS);
  Conditions conditions = conditions_for(nuisances.weather, seed);
  conditions.noise_sigma *= nuisances.noise_factor;
  const auto looks = random_looks(nuisances.looks, seed);
  Passage passage(nuisances.desynchronisation, seed_for(seed, "passage"));
  sample.images.resize(kImagesSize);
  RgbImage image(kNetworkWidthPx, kNetworkHeightPx);
  for (size_t i = 0; i < kCameraCount; ++i) {
    const CameraModel camera = true_camera(sample.rig.cameras[i], nuisances.calibration, random);
    const double offset_s = passage.next_offset_s();
    if (!sample.cameras[i]) continue;
    sample.reference_from_exposure[i] = passage.known_motion(offset_s);
    renderer.render(camera, map_from_vehicle * passage.true_motion(offset_s), stance,
                    time_s + offset_s, conditions, mix_seed(seed_for(seed, "noise") + i), image);
    if (nuisances.looks != CameraLooks{}) apply(looks[i], image);
    copy_as_planes(image, sample.images.data() + i * (kImagesSize / kCameraCount));
  }
}

/// The renderer and the rasterizers of one world.
struct WorldViews {
  Renderer renderer;
  MapRasterizer true_map;
  MapRasterizer localizer_map;  ///< rasterizer of the map with map errors
};

/// `given`: the rig of the stream, null if it has none.
Sample make_sample(const Nuisances& nuisances, const Rig* given, uint64_t seed,
                   const Se2& map_from_vehicle, WorldViews& views) {
  Random random(seed_for(seed, "prior"));
  Sample sample;
  sample.correction = random_correction(random);
  if (nuisances.rig_variety > 0.0) given = nullptr;
  sample.rig = network_rig(given != nullptr ? *given : random_rig(nuisances.rig_variety, seed));
  sample.cameras = random_cameras(nuisances.missing_cameras, random);
  take_images(views.renderer, map_from_vehicle, nuisances, seed, sample);
  if (given != nullptr) blacken_unseen(*given, sample);
  sample.raster_truth.resize(kRasterSize);
  views.true_map.draw(map_from_vehicle, sample.raster_truth);
  sample.raster_prior.resize(kRasterSize);
  views.localizer_map.draw(map_from_vehicle * sample.correction.inverse(), sample.raster_prior);
  return sample;
}

/// Makes a world. It does not depend on the nuisances, and so neither do the poses in it.
World world_of(const SampleStream& stream, uint64_t seed) {
  return stream.map != nullptr ? world_from_map(*stream.map, seed) : generate_world(seed);
}

}  // namespace

Se2 random_correction(Random& random) {
  return {random.uniform(-kMaxLongitudinalM, kMaxLongitudinalM),
          random.uniform(-kMaxLateralM, kMaxLateralM), random.uniform(-kMaxYawRad, kMaxYawRad)};
}

CameraMask random_cameras(const MissingCameras& missing, Random& random) {
  CameraMask cameras;
  cameras.set();
  if (!random.chance(missing.probability)) return cameras;
  const int count = random.integer(1, missing.most);
  for (int i = 0; i < count; ++i) cameras.reset(random.integer(0, kCameraCount - 1));
  return cameras;
}

const Rig& nominal_network_rig() {
  static const Rig rig = network_rig(nominal_rig());
  return rig;
}

void make_samples_of_world(const SampleStream& stream, uint64_t world_number, uint64_t first,
                           const std::function<bool(Sample&&)>& deliver) {
  const uint64_t world_seed = stream.first_seed + world_number;
  World world = world_of(stream, world_seed);
  world.photos = stream.photos;
  const std::vector<Se2> poses = poses_in(world, world_seed);
  const Nuisances of_world = drawn_for_world(stream.nuisances, stream.training, world_seed);
  wear_paint(of_world.paint_wear_factor, world);
  add_standing_vehicles(poses, of_world.extra_vehicles, world_seed, world);
  add_clutter(of_world.clutter, world_seed, world);
  add_verges(of_world.verge_share, world_seed, world);
  const HdMap surveyed_map = with_habits(world.map, of_world.map_habits, world_seed);
  const HdMap localizer_map = with_errors(surveyed_map, of_world.map_errors, world_seed);
  const MapIndex true_index(world.map);
  const MapIndex localizer_index(localizer_map);
  WorldViews views{Renderer(world), MapRasterizer(true_index), MapRasterizer(localizer_index)};
  for (uint64_t i = first; i < kSamplesPerWorld; ++i) {
    const uint64_t seed = sample_seed(stream, world_number * kSamplesPerWorld + i);
    const Nuisances nuisances = drawn_for_sample(of_world, stream.training, seed);
    if (!deliver(make_sample(nuisances, stream.rig, seed, poses[i], views))) return;
  }
}

}  // namespace bevloc::sim
