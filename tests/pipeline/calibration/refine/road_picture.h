// Pictures of a flat road whose grey levels follow from a formula.
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "pipeline/calibration/camera_model.h"
#include "pipeline/calibration/refine/grey_image.h"

namespace bevloc {

/// Draws what a lens sees of the ground and of an even sky.
class RoadPainter {
 public:
  explicit RoadPainter(const Intrinsics& lens) : lens_(lens) {
    for (int v = 0; v < lens.height_px * kParts; ++v) {
      for (int u = 0; u < lens.width_px * kParts; ++u) {
        rays_.push_back(lens.ray({in_pixels(u), in_pixels(v)}));
      }
    }
  }

  /// `grey_of` maps a point on the ground, in the map frame, to its grey level.
  template <typename Grey>
  GreyImage picture(const Se3& map_from_camera, const Grey& grey_of) const {
    constexpr double kSky = 150.0;
    const Eigen::Vector3d& from = map_from_camera.translation_m;
    std::vector<double> sums(static_cast<size_t>(lens_.width_px) * lens_.height_px);
    for (size_t i = 0; i < rays_.size(); ++i) {
      const Eigen::Vector3d ray = map_from_camera.rotation * rays_[i];
      const size_t row = i / (static_cast<size_t>(lens_.width_px) * kParts) / kParts;
      const size_t column = i / kParts % static_cast<size_t>(lens_.width_px);
      sums[row * static_cast<size_t>(lens_.width_px) + column] +=
          ray.z() < 0.0 ? grey_of((from - from.z() / ray.z() * ray).template head<2>().eval())
                        : kSky;
    }
    GreyImage image{lens_.width_px, lens_.height_px, {}};
    for (const double sum : sums) {
      image.pixels.push_back(static_cast<uint8_t>(sum / (kParts * kParts)));
    }
    return image;
  }

 private:
  static constexpr int kParts = 3;  // of a pixel, along each axis

  static double in_pixels(int part) { return (part + 0.5) / kParts - 0.5; }

  Intrinsics lens_;
  std::vector<Eigen::Vector3d> rays_;
};

}  // namespace bevloc
