// Panels: textured rectangles in space. Everything that stands on the ground is made of them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/render/surroundings.h"
#include "sim/render/texture.h"
#include "sim/vehicle/stance.h"

namespace bevloc::sim {

/// A rectangle with a texture. All positions are relative to the camera, in map axes.
struct Panel {
  /// Lower left corner.
  Eigen::Vector3f corner = Eigen::Vector3f::Zero();
  /// Unit vectors along the lower edge and up the panel.
  Eigen::Vector3f along = Eigen::Vector3f::UnitX();
  Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  float length_m = 0.0F;
  float height_m = 0.0F;
  Pattern pattern = Pattern::kPlain;
  const Texture* photo = nullptr;  ///< replaces the texture of the pattern

  const Texture& texture() const { return photo != nullptr ? *photo : texture_of(pattern); }
  /// Texture coordinates in periods: per metre along and up, and the value at the corner.
  float u_per_m = 0.0F;
  float v_per_m = 0.0F;
  float u_start = 0.0F;
  Rgb tint;
  /// 0 for a hard surface, 1 for foliage, which has no side in complete shadow.
  float softness = 0.0F;
  bool glows = false;  ///< bright untinted colours emit light at night
};

/// Makes the panels of everything that stands around the vehicle. One thread.
class PanelBuilder {
 public:
  /// Returns the panels that a camera at `camera` (map frame) may see, sorted from far to near.
  /// They stand on `ground`. The result is valid until the next call.
  const std::vector<Panel>& build(const Eigen::Vector3d& camera, const CurvedGround& ground,
                                  const Surroundings& surroundings);

 private:
  void add_wall(const WallPiece& piece);
  void add_post(const Post& post);
  void add_vehicle(const VehicleBody& body, bool lights_on);
  void add_vehicle_sides(const VehicleBody& body, const Se2& map_from_body);
  /// The point at `position`, `height_m` above the ground at `foot`, relative to the camera.
  Eigen::Vector3f from_camera(const Eigen::Vector2d& position, double height_m,
                              const Eigen::Vector2d& foot) const {
    const double above_plane_m = height_m + ground_.height_m(foot);
    return (Eigen::Vector3d(position.x(), position.y(), above_plane_m) - camera_).cast<float>();
  }

  const PhotoLibrary* photos_ = nullptr;
  Eigen::Vector3d camera_ = Eigen::Vector3d::Zero();
  CurvedGround ground_;
  std::vector<Panel> unsorted_;
  std::vector<Panel> panels_;
  std::vector<std::pair<float, int>> order_;
};

}  // namespace bevloc::sim
