#include "sim/faults/picture_faults.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "common/se2.h"
#include "sim/random.h"

namespace bevloc::sim {
namespace {

constexpr double kBlindedLevel = 250.0;

/// Rounded noise of a sensor, in 8-bit steps, from a table that is fast to draw from.
class SensorNoise {
 public:
  explicit SensorNoise(uint64_t seed) : random_(seed) {
    Random table_random(seed_for(seed, "table"));
    for (int8_t& step : steps_) {
      step = static_cast<int8_t>(std::lround(table_random.normal(0.0, kSigma)));
    }
  }

  /// The next eight values are the bytes of one random number.
  int next() {
    if (left_ == 0) {
      bits_ = random_.bits();
      left_ = 8;
    }
    const int step = steps_[bits_ & 0xFFU];
    bits_ >>= 8U;
    --left_;
    return step;
  }

 private:
  static constexpr double kSigma = 1.5;

  Random random_;
  std::array<int8_t, 256> steps_{};
  uint64_t bits_ = 0;
  int left_ = 0;
};

uint8_t to_pixel(double value, int noise) {
  return static_cast<uint8_t>(std::clamp(static_cast<int>(std::lround(value)) + noise, 0, 255));
}

void darken(RgbImage& image, double brightness, SensorNoise& noise) {
  for (uint8_t& pixel : image.pixels) pixel = to_pixel(brightness * pixel, noise.next());
}

/// Adds glare around a point above the middle of the picture. At strength 1 it covers the picture.
void blind(RgbImage& image, double strength, SensorNoise& noise) {
  const double reach_px = std::hypot(image.width, image.height);
  const double centre_u = 0.5 * image.width;
  const double centre_v = 0.25 * image.height;
  for (int v = 0; v < image.height; ++v) {
    uint8_t* row = image.row(v);
    for (int u = 0; u < image.width; ++u) {
      const double distance = std::hypot(u - centre_u, v - centre_v) / reach_px;
      const double glare = std::clamp(2.0 * strength - distance, 0.0, 1.0);
      if (glare <= 0.0) continue;
      for (int channel = 0; channel < 3; ++channel) {
        uint8_t& pixel = row[3 * u + channel];
        pixel = to_pixel(std::lerp(static_cast<double>(pixel), kBlindedLevel, glare), noise.next());
      }
    }
  }
}

/// Turns a camera, whose axes are right (x), down (y) and forward (z).
Eigen::Matrix3d turned(const Eigen::Matrix3d& vehicle_from_camera, const FaultAmounts& by) {
  const Eigen::Quaterniond to_left(
      Eigen::AngleAxisd(radians(by.yaw_deg), Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond down_and_tilted =
      Eigen::AngleAxisd(radians(-by.pitch_deg), Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(radians(by.roll_deg), Eigen::Vector3d::UnitZ());
  return to_left.toRotationMatrix() * vehicle_from_camera * down_and_tilted.toRotationMatrix();
}

}  // namespace

int source_camera(int camera, std::span<const Fault> active) {
  // Follows the cables from the computer to the cameras, so the latest swap comes first.
  for (auto latest = active.rbegin(); latest != active.rend(); ++latest) {
    const Fault& fault = *latest;
    if (fault.kind != FaultKind::kCameraSwapped || !fault.camera || !fault.other_camera) continue;
    if (*fault.camera == camera) {
      camera = *fault.other_camera;
    } else if (*fault.other_camera == camera) {
      camera = *fault.camera;
    }
  }
  return camera;
}

CameraModel disturbed(CameraModel camera, std::span<const Fault> active) {
  for (const Fault& fault : active) {
    Se3& pose = camera.vehicle_from_camera;
    const FaultAmounts& by = fault.amounts;
    if (fault.kind == FaultKind::kCameraTurned) pose.rotation = turned(pose.rotation, by);
    if (fault.kind == FaultKind::kCameraMoved) {
      pose.translation_m += Eigen::Vector3d(by.x_m, by.y_m, by.z_m);
    }
  }
  return camera;
}

void disturb_light(RgbImage& image, std::span<const Fault> active, uint64_t noise_seed) {
  for (const Fault& fault : active) {
    if (fault.kind != FaultKind::kCameraDark && fault.kind != FaultKind::kCameraBlinded) continue;
    SensorNoise noise(noise_seed);
    if (fault.kind == FaultKind::kCameraDark) darken(image, fault.amounts.brightness, noise);
    if (fault.kind == FaultKind::kCameraBlinded) blind(image, fault.amounts.strength, noise);
  }
}

}  // namespace bevloc::sim
