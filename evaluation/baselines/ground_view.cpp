#include "evaluation/baselines/ground_view.h"

#include <algorithm>
#include <cassert>

#include "pipeline/bev_grid.h"
#include "pipeline/preprocessing/image_remap.h"

namespace bevloc::evaluation {
namespace {

/// At this distance one pixel row of a network camera covers 0.6 m of ground, which is four cells.
/// The length grows with the square of the distance, so a line across the road gets lost.
constexpr double kFarthest_m = 14.0;

/// The mean of the three colours, interpolated between pixels. `pixel` lies inside the image.
float brightness_at(std::span<const uint8_t> image, const Eigen::Vector2f& pixel) {
  constexpr int kPlane = kNetworkWidthPx * kNetworkHeightPx;
  const int left = std::clamp(static_cast<int>(pixel.x()), 0, kNetworkWidthPx - 2);
  const int top = std::clamp(static_cast<int>(pixel.y()), 0, kNetworkHeightPx - 2);
  const float right = pixel.x() - static_cast<float>(left);
  const float down = pixel.y() - static_cast<float>(top);
  float sum = 0.0F;
  for (int colour = 0; colour < 3; ++colour) {
    const uint8_t* above = &image[colour * kPlane + top * kNetworkWidthPx + left];
    const uint8_t* below = above + kNetworkWidthPx;
    const float upper = (1.0F - right) * above[0] + right * above[1];
    const float lower = (1.0F - right) * below[0] + right * below[1];
    sum += (1.0F - down) * upper + down * lower;
  }
  return sum / 3.0F;
}

}  // namespace

GroundView::GroundView(const Rig& network_rig)
    : projections_(static_cast<size_t>(kRasterGrid.cells())) {
  for (size_t i = 0; i < kCameraCount; ++i) {
    const CameraModel& camera = network_rig.cameras[i];
    const Se3 camera_from_vehicle = camera.vehicle_from_camera.inverse();
    for (int cell = 0; cell < kRasterGrid.cells(); ++cell) {
      const Eigen::Vector3d ground(kRasterGrid.x_of_row(cell / kRasterGrid.cols),
                                   kRasterGrid.y_of_col(cell % kRasterGrid.cols), 0.0);
      if ((ground - camera.vehicle_from_camera.translation_m).norm() > kFarthest_m) continue;
      const auto pixel = camera.intrinsics.project(camera_from_vehicle * ground);
      if (!pixel) continue;
      const double border_px = std::min({pixel->x(), kNetworkWidthPx - 1.0 - pixel->x(), pixel->y(),
                                         kNetworkHeightPx - 1.0 - pixel->y()});
      if (border_px <= 0.0) continue;
      projections_[cell][i] = {pixel->cast<float>(), static_cast<float>(border_px)};
    }
  }
}

GroundImage GroundView::project(std::span<const uint8_t> images, CameraMask cameras) const {
  assert(images.size() == kCameraCount * kNetworkImageSize);
  GroundImage ground{cv::Mat1f(kRasterGrid.rows, kRasterGrid.cols, 0.0F),
                     cv::Mat1b(kRasterGrid.rows, kRasterGrid.cols, uchar{0})};
  for (size_t cell = 0; cell < projections_.size(); ++cell) {
    size_t best = kCameraCount;
    float best_border_px = 0.0F;
    for (size_t i = 0; i < kCameraCount; ++i) {
      if (!cameras[i] || projections_[cell][i].border_distance_px <= best_border_px) continue;
      best = i;
      best_border_px = projections_[cell][i].border_distance_px;
    }
    if (best == kCameraCount) continue;
    const auto image = images.subspan(best * kNetworkImageSize, kNetworkImageSize);
    ground.brightness.begin()[cell] = brightness_at(image, projections_[cell][best].pixel);
    ground.seen.begin()[cell] = 255;
  }
  return ground;
}

}  // namespace bevloc::evaluation
