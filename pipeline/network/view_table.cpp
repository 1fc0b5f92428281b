#include "pipeline/network/view_table.h"

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
  double border_distance_px =
      0.0;  ///< from the nearest image border; 0 if it does not see the cell
};

Sighting sight(const CameraModel& camera, const Se3& camera_from_vehicle, int camera_index,
               const Eigen::Vector3d& point_vehicle) {
  const auto pixel = camera.intrinsics.project(camera_from_vehicle * point_vehicle);
  if (!pixel) return {};
  const double u = pixel->x() + 0.5;
  const double v = pixel->y() + 0.5;
  const double distance = std::min({u, kNetworkWidthPx - u, v, kNetworkHeightPx - v});
  return {camera_index, *pixel, std::max(0.0, distance)};
}

/// Writes the bilinear neighbours of a pixel into the table's next four slots of one cell.
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

/// Shares of the two best cameras. A third camera's distance is taken off both, so that the second
/// place changes hands at a share of zero.
std::array<double, kCamerasPerCell> shares(const std::array<Sighting, kCameraCount>& best_first) {
  const double first = best_first[0].border_distance_px - best_first[2].border_distance_px;
  const double second = best_first[1].border_distance_px - best_first[2].border_distance_px;
  if (first <= 0.0) return {best_first[0].border_distance_px > 0.0 ? 1.0 : 0.0, 0.0};
  return {first / (first + second), second / (first + second)};
}

}  // namespace

ViewTable make_view_table(const Rig& rig, CameraMask available, const BevGrid& grid) {
  ViewTable table;
  update_view_table(rig, available, grid, table);
  return table;
}

void update_view_table(const Rig& rig, CameraMask available, const BevGrid& grid,
                       ViewTable& table) {
  const size_t cells = static_cast<size_t>(grid.cells());
  table.index.assign(kViewSlots * cells, 0);
  table.weight.assign(kViewSlots * cells, 0.0F);

  std::array<Se3, kCameraCount> camera_from_vehicle;
  for (int i = 0; i < kCameraCount; ++i) {
    assert(rig.cameras[i].intrinsics.width_px == kNetworkWidthPx &&
           rig.cameras[i].intrinsics.height_px == kNetworkHeightPx);
    camera_from_vehicle[i] = rig.cameras[i].vehicle_from_camera.inverse();
  }

  for (size_t cell = 0; cell < cells; ++cell) {
    const int row = static_cast<int>(cell) / grid.cols;
    const int col = static_cast<int>(cell) % grid.cols;
    const Eigen::Vector3d centre(grid.x_of_row(row), grid.y_of_col(col), 0.0);
    std::array<Sighting, kCameraCount> sightings;
    for (int i = 0; i < kCameraCount; ++i) {
      if (available[i]) sightings[i] = sight(rig.cameras[i], camera_from_vehicle[i], i, centre);
    }
    std::partial_sort(sightings.begin(), sightings.begin() + 3, sightings.end(),
                      [](const Sighting& a, const Sighting& b) {
                        return a.border_distance_px > b.border_distance_px;
                      });
    const auto share = shares(sightings);
    for (int k = 0; k < kCamerasPerCell; ++k) {
      if (share[k] <= 0.0) continue;
      const size_t first_slot = k * kNeighbours * cells + cell;
      write_neighbours(sightings[k], share[k], cells, &table.index[first_slot],
                       &table.weight[first_slot]);
    }
  }
}

}  // namespace bevloc
