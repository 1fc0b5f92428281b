// Finds painted lines in an image, to a fraction of a pixel, near where the map has them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pipeline/calibration/camera_model.h"
#include "pipeline/calibration/refine/grey_image.h"
#include "pipeline/calibration/refine/paint_lines.h"

namespace bevloc {

/// One place in an image where the map has paint, and the paint that was found across it.
struct PaintSighting {
  static constexpr int kMostCandidates = 3;

  Eigen::Vector2d point_m;       ///< in the map frame, on the ground
  uint32_t element = 0;          ///< index of the element in the map
  Eigen::Vector2d predicted_px;  ///< pixel of point_m by the camera and pose of find_paint()
  Eigen::Vector2d normal_px;     ///< unit, across the line in the image
  double pixels_per_m = 0.0;     ///< along the normal, per metre across the line on the ground
  int candidates = 0;
  /// Offsets of the paint along the normal from predicted_px, the strongest first.
  std::array<double, kMostCandidates> offset_px{};
};

/// Searches the image for paint at each point where the camera should see a line at least 1 px
/// wide, up to `reach_px` to either side of the predicted line. Points without paint have sightings
/// without candidates. A stripe has a rising and a falling edge that are 0.06 to 0.30 m apart, and
/// similar ground on both sides. A step has a rising edge towards its bright side. `camera` and
/// `vehicle_from_map` are the best known ones.
std::vector<PaintSighting> find_paint(const GreyImage& image, const CameraModel& camera,
                                      const Se2& vehicle_from_map,
                                      std::span<const PaintPoint> points, double reach_px);

}  // namespace bevloc
