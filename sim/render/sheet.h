// Flat rectangles in space: all that stands on the ground is drawn with them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/render/surroundings.h"
#include "sim/render/texture.h"

namespace bevloc::sim {

struct Sheet {
  /// Lower left corner, counted from the camera, in map axes.
  Eigen::Vector3f corner = Eigen::Vector3f::Zero();
  /// Unit vectors along the foot and up the sheet.
  Eigen::Vector3f along = Eigen::Vector3f::UnitX();
  Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  float length_m = 0.0F;
  float height_m = 0.0F;
  Pattern pattern = Pattern::kPlain;
  /// Place in the picture: period shares per metre, and the share at the corner.
  float u_per_m = 0.0F;
  float v_per_m = 0.0F;
  float u_start = 0.0F;
  Rgb tint;
  /// 0 for a hard surface, 1 for foliage, which has no side that is all in shadow.
  float softness = 0.0F;
  bool glows = false;  ///< its bright own colours shine at night
};

/// All sheets of the surroundings that a camera at `camera` (map frame) may see, far ones first.
class SheetBuilder {
 public:
  const std::vector<Sheet>& build(const Eigen::Vector3d& camera, const Surroundings& surroundings);

 private:
  void add_wall(const WallPiece& piece);
  void add_post(const Post& post);
  void add_vehicle(const VehicleBody& body, bool lights_on);
  void add_vehicle_sides(const VehicleBody& body, const Se2& map_from_body);
  Eigen::Vector3f from_camera(const Eigen::Vector2d& position, double height_m) const {
    return (Eigen::Vector3d(position.x(), position.y(), height_m) - camera_).cast<float>();
  }

  Eigen::Vector3d camera_ = Eigen::Vector3d::Zero();
  std::vector<Sheet> unsorted_;
  std::vector<Sheet> sheets_;
  std::vector<std::pair<float, int>> order_;
};

}  // namespace bevloc::sim
