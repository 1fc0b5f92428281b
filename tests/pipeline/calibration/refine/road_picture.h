// Pictures of a flat road whose grey levels follow from a formula.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "pipeline/calibration/camera_model.h"
#include "pipeline/calibration/refine/grey_image.h"

namespace bevloc {

/// Draws what a lens sees of the ground and of an even sky. The loops use plain numbers, because
/// sanitizers make Eigen slow.
class RoadPainter {
 public:
  explicit RoadPainter(const Intrinsics& lens) : lens_(lens) {
    for (int v = 0; v < lens.height_px; ++v) {
      for (int u = 0; u < lens.width_px; ++u) {
        for (int i = 0; i < kParts * kParts; ++i) {
          const Eigen::Vector3d ray =
              lens.ray({u + in_pixel(i % kParts), v + in_pixel(i / kParts)});
          rays_.push_back({ray.x(), ray.y(), ray.z()});
        }
      }
    }
  }

  /// `grey_of(x_m, y_m)` is the grey level of a point on the ground, in the map frame.
  template <typename Grey>
  GreyImage picture(const Se3& map_from_camera, const Grey& grey_of) const {
    constexpr double kSky = 150.0;
    const Eigen::Vector3d& from = map_from_camera.translation_m;
    const double x = from.x();
    const double y = from.y();
    const double z = from.z();
    std::array<double, 9> r;  // row by row
    for (size_t i = 0; i < r.size(); ++i) {
      r[i] = map_from_camera.rotation(static_cast<int>(i) / 3, static_cast<int>(i) % 3);
    }
    GreyImage image{lens_.width_px, lens_.height_px, {}};
    image.pixels.reserve(rays_.size() / (kParts * kParts));
    double sum = 0.0;
    int part = 0;
    for (const Ray& ray : rays_) {
      const double down = -(r[6] * ray.x + r[7] * ray.y + r[8] * ray.z);
      const double far = z / down;
      sum += down > 0.0 ? grey_of(x + far * (r[0] * ray.x + r[1] * ray.y + r[2] * ray.z),
                                  y + far * (r[3] * ray.x + r[4] * ray.y + r[5] * ray.z))
                        : kSky;
      if (++part < kParts * kParts) continue;
      image.pixels.push_back(static_cast<uint8_t>(sum / (kParts * kParts)));
      sum = 0.0;
      part = 0;
    }
    return image;
  }

 private:
  static constexpr int kParts = 2;  // of a pixel, along each axis

  struct Ray {
    double x;
    double y;
    double z;
  };

  static double in_pixel(int part) { return (part + 0.5) / kParts - 0.5; }

  Intrinsics lens_;
  std::vector<Ray> rays_;
};

}  // namespace bevloc
