// Projects the lines of the HD map into a camera image and into the vehicle's plane.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/calibration/camera_model.h"
#include "pipeline/map/map_index.h"

namespace bevloc {

/// One piece of the map's lines as connected points.
struct ProjectedLine {
  ElementClass element_class = ElementClass::kLaneDivider;
  std::vector<Eigen::Vector2d> points;
};

/// The map's lines within a square of `reach_m` around a pose, in metres in the vehicle frame.
/// Consecutive segments of one element are one line. One thread. The map must outlive it.
class ProjectedMap {
 public:
  /// The ground beyond this distance takes only a few pixels of a camera image.
  static constexpr double kCameraReach_m = 40.0;

  explicit ProjectedMap(const MapIndex& map) : map_(map) {}

  /// The result is valid until the next call of any member.
  std::span<const ProjectedLine> around(const Se2& map_from_vehicle, double reach_m);

  /// The lines as a camera, with its distortion, sees them on flat ground, in pixels of its
  /// full-size image. They reach up to 200 pixels beyond the image. Parts behind the camera are
  /// left out. The result is valid until the next call of any member.
  std::span<const ProjectedLine> in_image(const Se2& map_from_vehicle, const CameraModel& camera);

 private:
  const MapIndex& map_;
  std::vector<MapIndex::Segment> found_;
  std::vector<ProjectedLine> around_;
  std::vector<ProjectedLine> in_image_;
};

}  // namespace bevloc
