#include "pipeline/localization/projected_map.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace bevloc {
namespace {

/// Lens distortion bends a straight line, so it is projected in pieces of this length.
constexpr double kPieceLength_m = 0.5;
constexpr double kNearest_m = 0.3;
constexpr double kMargin_px = 200.0;

/// The pixel of a point on the ground. Returns nothing if it is not in or near the image.
std::optional<Eigen::Vector2d> pixel_of(const CameraModel& camera, const Se3& camera_from_vehicle,
                                        const Eigen::Vector2d& point_vehicle) {
  const Eigen::Vector3d point =
      camera_from_vehicle * Eigen::Vector3d(point_vehicle.x(), point_vehicle.y(), 0.0);
  if (point.z() < kNearest_m) return std::nullopt;
  const auto pixel = camera.intrinsics.project(point);
  if (!pixel) return std::nullopt;
  const Eigen::Vector2d size(camera.intrinsics.width_px, camera.intrinsics.height_px);
  const bool near =
      (pixel->array() > -kMargin_px).all() && (pixel->array() < size.array() + kMargin_px).all();
  return near ? pixel : std::nullopt;
}

}  // namespace

std::span<const ProjectedLine> ProjectedMap::around(const Se2& map_from_vehicle, double reach_m) {
  const Eigen::Vector2d reach(reach_m, reach_m);
  map_.query(map_from_vehicle.translation() - reach, map_from_vehicle.translation() + reach,
             found_);
  const Se2 vehicle_from_map = map_from_vehicle.inverse();
  around_.clear();
  const MapIndex::Segment* previous = nullptr;
  for (const MapIndex::Segment& segment : found_) {
    const MapElement& element = map_.map().elements[segment.element];
    const bool goes_on = previous != nullptr && previous->element == segment.element &&
                         previous->first + 1 == segment.first;
    if (!goes_on) {
      around_.push_back(
          {element.element_class, {vehicle_from_map * element.points[segment.first]}});
    }
    around_.back().points.push_back(vehicle_from_map * segment_end(element, segment.first));
    previous = &segment;
  }
  return around_;
}

std::span<const ProjectedLine> ProjectedMap::in_image(const Se2& map_from_vehicle,
                                                      const CameraModel& camera) {
  const Se3 camera_from_vehicle = camera.vehicle_from_camera.inverse();
  in_image_.clear();
  for (const ProjectedLine& line : around(map_from_vehicle, kCameraReach_m)) {
    bool connected = false;
    const auto add = [&](const Eigen::Vector2d& point) {
      const auto pixel = pixel_of(camera, camera_from_vehicle, point);
      if (pixel && !connected) in_image_.push_back({line.element_class, {}});
      if (pixel) in_image_.back().points.push_back(*pixel);
      connected = pixel.has_value();
    };
    add(line.points.front());
    for (size_t i = 1; i < line.points.size(); ++i) {
      const Eigen::Vector2d& from = line.points[i - 1];
      const Eigen::Vector2d step = line.points[i] - from;
      const int pieces = std::max(1, static_cast<int>(std::ceil(step.norm() / kPieceLength_m)));
      for (int piece = 1; piece <= pieces; ++piece) {
        add(from + step * (static_cast<double>(piece) / pieces));
      }
    }
  }
  std::erase_if(in_image_, [](const ProjectedLine& line) { return line.points.size() < 2; });
  return in_image_;
}

}  // namespace bevloc
