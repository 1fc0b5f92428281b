#include "evaluation/bench/stage_work.h"

#include <algorithm>
#include <cmath>

#include "pipeline/map/rasterizer.h"
#include "pipeline/network/network.h"
#include "pipeline/preprocessing/image_remap.h"

namespace bevloc::bench {
namespace {

/// Blocks of pixels have their own entries. Each of the other pixels has two positions and two sets
/// of weights.
double table_bytes(const RemapTable& table) {
  const RemapBlocks& blocks = table.blocks;
  size_t entries = blocks.index.size() + blocks.first_col.size() + blocks.first_row.size();
  for (const auto [begin, end] : blocks.others) {
    entries += static_cast<size_t>(end - begin) * (2 + 2 * static_cast<size_t>(table.taps));
  }
  return static_cast<double>(entries * sizeof(uint16_t) + blocks.weights.size());
}

double rows_read(const RemapTable& table, const CameraModel& camera) {
  const auto [first, last] = std::ranges::minmax(table.first_row);
  return std::min<double>(last - first + table.taps, camera.intrinsics.height_px);
}

double mean_segments(const Scene& scene, const MapIndex& index) {
  std::vector<MapIndex::Segment> found;
  double sum = 0.0;
  for (const Place& place : scene.places) {
    const Surroundings around = surroundings_of(place.map_from_vehicle);
    index.query(around.min_corner, around.max_corner, found);
    sum += static_cast<double>(found.size());
  }
  return sum / static_cast<double>(scene.places.size());
}

}  // namespace

Work image_path_work(const Rig& rig, PixelFormat format) {
  Work work;
  for (const CameraModel& camera : rig.cameras) {
    const RemapTable table = make_remap_table(camera);
    work.bytes += table_bytes(table) + static_cast<double>(kNetworkImageSize) +
                  rows_read(table, camera) * camera.intrinsics.width_px * bytes_per_pixel(format);
  }
  return work;
}

Work decode_work(const Rig& rig, const ConvertedImages& files) {
  Work work;
  for (size_t camera = 0; camera < files.size(); ++camera) {
    const auto& lens = rig.cameras[camera].intrinsics;
    work.bytes += static_cast<double>(files[camera].bytes.size()) +
                  lens.width_px * lens.height_px * bytes_per_pixel(PixelFormat::kMjpeg);
  }
  return work;
}

Work map_crop_work(const Scene& scene, const MapIndex& index) {
  constexpr size_t kBytesPerSegment = sizeof(MapIndex::Segment) + 2 * sizeof(Eigen::Vector2d);
  return {0.0, mean_segments(scene, index) * static_cast<double>(kBytesPerSegment)};
}

Work map_raster_work(const Scene& scene, const MapIndex& index) {
  return {0.0, map_crop_work(scene, index).bytes + static_cast<double>(kRasterSize)};
}

Work solver_work() {
  return {0.0, 2.0 * kFeatureChannels * kFeatureGrid.cells() * sizeof(float)};
}

Work view_table_work() {
  return {0.0, double{kViewSlots} * kFeatureGrid.cells() * (sizeof(int32_t) + sizeof(float))};
}

Work network_work(const BranchCost& cost) {
  return {static_cast<double>(cost.macs), static_cast<double>(cost.bytes())};
}

Surroundings surroundings_of(const Se2& map_from_vehicle) {
  const double c = std::abs(std::cos(map_from_vehicle.yaw_rad));
  const double s = std::abs(std::sin(map_from_vehicle.yaw_rad));
  const double x = kRasterGrid.x_range_m();
  const double y = kRasterGrid.y_range_m();
  const Eigen::Vector2d half(c * x + s * y, s * x + c * y);
  return {map_from_vehicle.translation() - half, map_from_vehicle.translation() + half};
}

}  // namespace bevloc::bench
