#include "training/native/sample_maker.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pipeline/map/map_index.h"
#include "pipeline/map/rasterizer.h"
#include "sim/random.h"
#include "sim/render/renderer.h"
#include "sim/sim_rig.h"
#include "sim/vehicle/placement.h"
#include "sim/world/world_generator.h"

namespace bevloc::training {
namespace {

using sim::Random;
using sim::seed_for;

// How far the prior pose may be off, each way.
constexpr double kMaxLongitudinalM = 2.0;
constexpr double kMaxLateralM = 1.0;
constexpr double kMaxYawRad = radians(2.0);

// What is left of a camera's calibration error on a vehicle, one sigma.
constexpr double kRotationSigmaRad = radians(0.12);
constexpr double kPositionSigmaM = 0.008;
constexpr double kFocalSigma = 0.002;

// How the body stands over its wheels, one sigma.
constexpr double kTiltSigmaRad = radians(0.35);
constexpr double kLiftSigmaM = 0.025;

// Traffic repeats nowhere near this soon.
constexpr double kTrafficTimeS = 600.0;

// Two samples of a world are at least this far apart, or turned this much, if the world has room.
constexpr double kApartM = 15.0;
constexpr double kApartRad = radians(60.0);
constexpr int kPoseTries = 20;

uint64_t sample_seed(const Stream& stream, uint64_t sample) {
  return sim::mix_seed(seed_for(stream.first_seed, "sample") + sample);
}

bool is_apart(const Se2& a, const Se2& b) {
  return (a.translation() - b.translation()).norm() > kApartM ||
         std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) > kApartRad;
}

/// The poses of all samples of a world. All are drawn even when a stream resumes in the middle,
/// because each must keep away from those before it.
std::vector<Se2> poses_in(const sim::World& world, uint64_t world_seed) {
  std::vector<Se2> poses;
  Random random(seed_for(world_seed, "poses"));
  while (poses.size() < kSamplesPerWorld) {
    Se2 pose;
    for (int attempt = 0; attempt < kPoseTries; ++attempt) {
      pose = sim::random_pose_on_road(world, random);
      if (std::all_of(poses.begin(), poses.end(),
                      [&pose](const Se2& other) { return is_apart(pose, other); })) {
        break;
      }
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

/// The camera that really takes the pictures behind the network camera that calibration promises.
/// The crop stays where calibration puts it: an error of pitch moves the horizon.
CameraModel true_camera(const CameraModel& told, Random& random) {
  CameraModel camera = told;
  const Eigen::Vector3d rotation = random_vector(kRotationSigmaRad, random);
  const double angle = rotation.norm();
  camera.vehicle_from_camera.rotation *=
      Eigen::AngleAxisd(angle, rotation / std::max(angle, 1e-12)).toRotationMatrix();
  camera.vehicle_from_camera.translation_m += random_vector(kPositionSigmaM, random);
  const double focal_factor = random.normal(1.0, kFocalSigma);
  camera.intrinsics.fx_px *= focal_factor;
  camera.intrinsics.fy_px *= focal_factor;
  return camera;
}

/// All cameras, or all but one or two.
CameraMask random_cameras(double drop_probability, Random& random) {
  CameraMask cameras;
  cameras.set();
  if (!random.chance(drop_probability)) return cameras;
  const int missing = random.integer(1, 2);
  for (int i = 0; i < missing; ++i) cameras.reset(random.integer(0, kCameraCount - 1));
  return cameras;
}

void copy_as_planes(const RgbImage& image, uint8_t* planes) {
  const size_t count = static_cast<size_t>(image.width) * image.height;
  for (size_t i = 0; i < count; ++i) {
    for (size_t colour = 0; colour < 3; ++colour) {
      planes[colour * count + i] = image.pixels[3 * i + colour];
    }
  }
}

/// Images of the cameras of `cameras`; black for the others.
std::vector<uint8_t> make_images(sim::Renderer& renderer, const Se2& map_from_vehicle,
                                 CameraMask cameras, uint64_t seed) {
  Random random(seed_for(seed, "body and cameras"));
  const sim::BodyMotion body{.pitch_rad = random.normal(0.0, kTiltSigmaRad),
                             .roll_rad = random.normal(0.0, kTiltSigmaRad),
                             .lift_m = random.normal(0.0, kLiftSigmaM)};
  const double time_s = random.uniform(0.0, kTrafficTimeS);
  const sim::Conditions conditions = sim::random_conditions(seed_for(seed, "conditions"));
  std::vector<uint8_t> images(kImagesSize);
  RgbImage image(kNetworkWidthPx, kNetworkHeightPx);
  for (size_t i = 0; i < kCameraCount; ++i) {
    const CameraModel camera = true_camera(told_network_rig().cameras[i], random);
    if (!cameras[i]) continue;
    renderer.render(camera, map_from_vehicle, body, time_s, conditions,
                    sim::mix_seed(seed_for(seed, "noise") + i), image);
    copy_as_planes(image, images.data() + i * (kImagesSize / kCameraCount));
  }
  return images;
}

Sample make_sample(const Stream& stream, uint64_t seed, const Se2& map_from_vehicle,
                   sim::Renderer& renderer, MapRasterizer& rasterizer) {
  Random random(seed_for(seed, "prior"));
  Sample sample;
  sample.correction = {random.uniform(-kMaxLongitudinalM, kMaxLongitudinalM),
                       random.uniform(-kMaxLateralM, kMaxLateralM),
                       random.uniform(-kMaxYawRad, kMaxYawRad)};
  sample.cameras = random_cameras(stream.drop_camera_probability, random);
  sample.images = make_images(renderer, map_from_vehicle, sample.cameras, seed);
  sample.raster_truth.resize(kRasterSize);
  rasterizer.draw(map_from_vehicle, sample.raster_truth);
  sample.raster_prior.resize(kRasterSize);
  rasterizer.draw(map_from_vehicle * sample.correction.inverse(), sample.raster_prior);
  return sample;
}

}  // namespace

const Rig& told_network_rig() {
  static const Rig rig = network_rig(sim::nominal_rig());
  return rig;
}

void make_samples_of_world(const Stream& stream, uint64_t world_number, uint64_t first,
                           const std::function<bool(Sample&&)>& deliver) {
  const uint64_t world_seed = stream.first_seed + world_number;
  const sim::World world = sim::generate_world(world_seed);
  const std::vector<Se2> poses = poses_in(world, world_seed);
  const MapIndex index(world.map);
  MapRasterizer rasterizer(index);
  sim::Renderer renderer(world);
  for (uint64_t i = first; i < kSamplesPerWorld; ++i) {
    const uint64_t seed = sample_seed(stream, world_number * kSamplesPerWorld + i);
    if (!deliver(make_sample(stream, seed, poses[i], renderer, rasterizer))) return;
  }
}

}  // namespace bevloc::training
