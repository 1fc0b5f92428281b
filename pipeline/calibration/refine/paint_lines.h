// Points on the map's painted lines around a vehicle.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/map/map_index.h"

namespace bevloc {

/// What the paint looks like across the line.
enum class PaintKind : uint8_t {
  kStripe,  ///< bright between two dark sides: a lane divider
  kStep,    ///< bright on one side: the end of the bars of a crossing
};

struct PaintPoint {
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();  ///< in the map frame, on the ground
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();   ///< unit, in the map frame
  /// Unit, to the left of `along`; for a step it points to the bright side.
  Eigen::Vector2d across = Eigen::Vector2d::UnitY();
  PaintKind kind = PaintKind::kStripe;
  uint32_t element = 0;
};

/// Replaces `points` by points every 0.2 m on lane dividers, and on the two longer opposite sides
/// of crossings with four corners, within `reach_m` of the vehicle. Double lines are left out,
/// because it is not known which of the two lines the map means. Boundaries are left out, too,
/// because they are not painted.
void find_paint_points(const MapIndex& map, const Se2& map_from_vehicle, double reach_m,
                       std::vector<PaintPoint>& points);

}  // namespace bevloc
