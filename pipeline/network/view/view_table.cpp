#include "pipeline/network/view/view_table.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {
namespace {

static_assert(kImageFeatureRows * kImageFeatureStride == kNetworkHeightPx);
static_assert(kImageFeatureCols * kImageFeatureStride == kNetworkWidthPx);

constexpr int kNeighbours = 4;
constexpr int kCamerasPerCell = kViewSlots / kNeighbours;

/// How one camera sees one cell.
struct Sighting {
  int camera = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  /// Distance to the nearest image border; 0 if the camera does not see the cell.
  double border_distance_px = 0.0;
};

/// Projects points on the ground plane, given in the reference frame, into one camera. The
/// constructor computes what is the same for all points.
class GroundView {
 public:
  GroundView() = default;
  GroundView(const CameraModel& camera, int camera_index, const Se2& reference_from_exposure)
      : intrinsics_(camera.intrinsics), camera_(camera_index) {
    assert(intrinsics_.width_px == kNetworkWidthPx && intrinsics_.height_px == kNetworkHeightPx);
    assert(intrinsics_.is_straight());
    const Se3 camera_from_reference =
        camera.vehicle_from_camera.inverse() * motion_in_space(reference_from_exposure.inverse());
    along_x_ = camera_from_reference.rotation.col(0);
    along_y_ = camera_from_reference.rotation.col(1);
    origin_m_ = camera_from_reference.translation_m;
  }

  Sighting sight(double x_m, double y_m) const {
    const double depth_m = along_x_.z() * x_m + along_y_.z() * y_m + origin_m_.z();
    if (!(depth_m > 0.0)) return {};
    const Eigen::Vector3d point_m = along_x_ * x_m + along_y_ * y_m + origin_m_;
    const Eigen::Vector2d pixel(intrinsics_.fx_px * (point_m.x() / depth_m) + intrinsics_.cx_px,
                                intrinsics_.fy_px * (point_m.y() / depth_m) + intrinsics_.cy_px);
    const double u = pixel.x() + 0.5;
    const double v = pixel.y() + 0.5;
    const double distance = std::min({u, kNetworkWidthPx - u, v, kNetworkHeightPx - v});
    return {camera_, pixel, std::max(0.0, distance)};
  }

 private:
  /// The planar motion as a motion in 3-D space.
  static Se3 motion_in_space(const Se2& motion) {
    Se3 result;
    const double c = std::cos(motion.yaw_rad);
    const double s = std::sin(motion.yaw_rad);
    result.rotation.topLeftCorner<2, 2>() << c, -s, s, c;
    result.translation_m = {motion.x_m, motion.y_m, 0.0};
    return result;
  }

  Intrinsics intrinsics_;
  int camera_ = 0;
  // Axes and origin of the reference frame, in the camera frame.
  Eigen::Vector3d along_x_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d along_y_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
};

/// Keeps the sightings with the largest border distances, in descending order.
class BestSightings {
 public:
  static constexpr int kKept = kCamerasPerCell + 1;

  void add(const Sighting& sighting) {
    if (sighting.border_distance_px <= best_first_.back().border_distance_px) return;
    int place = kKept - 1;
    for (; place > 0; --place) {
      if (best_first_[place - 1].border_distance_px >= sighting.border_distance_px) break;
      best_first_[place] = best_first_[place - 1];
    }
    best_first_[place] = sighting;
  }

  const Sighting& operator[](int place) const { return best_first_[place]; }

  /// Shares of the two best cameras. The border distance of the third is subtracted from both, so
  /// that the second camera's share is zero when the third one takes its place.
  std::array<double, kCamerasPerCell> shares() const {
    const double best = best_first_[0].border_distance_px;
    const double third = best_first_[2].border_distance_px;
    const double first = best - third;
    const double second = best_first_[1].border_distance_px - third;
    if (first <= 0.0) return {best > 0.0 ? 1.0 : 0.0, 0.0};
    return {first / (first + second), second / (first + second)};
  }

 private:
  std::array<Sighting, kKept> best_first_;
};

/// Writes the four bilinear neighbours of a pixel into four slots of one cell. `index` and `weight`
/// point to the entry of the first slot.
void write_neighbours(const Sighting& sighting, double share, size_t slot_stride, int32_t* index,
                      float* weight) {
  const double row = (sighting.pixel.y() + 0.5) / kImageFeatureStride - 0.5;
  const double col = (sighting.pixel.x() + 0.5) / kImageFeatureStride - 0.5;
  const int top = static_cast<int>(std::floor(row));
  const int left = static_cast<int>(std::floor(col));
  for (int n = 0; n < kNeighbours; ++n) {
    const int r = top + n / 2;
    const int c = left + n % 2;
    const double bilinear = (1.0 - std::abs(row - r)) * (1.0 - std::abs(col - c));
    const int inside_row = std::clamp(r, 0, kImageFeatureRows - 1);
    const int inside_col = std::clamp(c, 0, kImageFeatureCols - 1);
    index[n * slot_stride] =
        sighting.camera * kImageFeatureCells + inside_row * kImageFeatureCols + inside_col;
    weight[n * slot_stride] = static_cast<float>(share * bilinear);
  }
}

}  // namespace

ViewTable make_view_table(const Rig& rig, CameraMask available, const BevGrid& grid,
                          const CameraMotions& reference_from_exposure) {
  ViewTable table;
  update_view_table(rig, available, grid, reference_from_exposure, table);
  return table;
}

void update_view_table(const Rig& rig, CameraMask available, const BevGrid& grid,
                       const CameraMotions& reference_from_exposure, ViewTable& table) {
  const size_t cells = static_cast<size_t>(grid.cells());
  table.index.assign(kViewSlots * cells, 0);
  table.weight.assign(kViewSlots * cells, 0.0F);

  std::array<GroundView, kCameraCount> views;
  int view_count = 0;
  for (int i = 0; i < kCameraCount; ++i) {
    if (!available[i]) continue;
    views[view_count++] = GroundView(rig.cameras[i], i, reference_from_exposure[i]);
  }

  for (size_t cell = 0; cell < cells; ++cell) {
    const double x_m = grid.x_of_row(static_cast<int>(cell) / grid.cols);
    const double y_m = grid.y_of_col(static_cast<int>(cell) % grid.cols);
    BestSightings sightings;
    for (int view = 0; view < view_count; ++view) sightings.add(views[view].sight(x_m, y_m));
    const auto share = sightings.shares();
    for (int k = 0; k < kCamerasPerCell; ++k) {
      if (share[k] <= 0.0) continue;
      const size_t first_slot = k * kNeighbours * cells + cell;
      write_neighbours(sightings[k], share[k], cells, &table.index[first_slot],
                       &table.weight[first_slot]);
    }
  }
}

}  // namespace bevloc
