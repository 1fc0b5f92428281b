// The simulated world: everything that the cameras can see, as geometry in the map frame (metres).
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "common/plane.h"
#include "common/se2.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::sim {

using Ring = std::vector<Eigen::Vector2d>;

/// A colour: linear reflectance or radiance.
struct Rgb {
  float r = 0.0F;
  float g = 0.0F;
  float b = 0.0F;
};

enum class GroundMaterial : uint8_t { kAsphalt, kConcrete, kPaving, kGrass, kDirt, kGravel };
inline constexpr size_t kGroundMaterials = 6;

/// A patch of ground. In World::surfaces a later surface covers an earlier one.
struct Surface {
  GroundMaterial material = GroundMaterial::kAsphalt;
  float brightness = 1.0F;  ///< factor on the material's usual albedo
  Ring ring;
};

/// A painted line. With dash_m = 0 it is solid.
struct PaintLine {
  Polyline points;
  double width_m = 0.12;
  double dash_m = 0.0;
  double gap_m = 0.0;
  double phase_m = 0.0;  ///< place in the dash pattern where the line begins
  Rgb albedo{0.8F, 0.8F, 0.8F};
  float wear = 0.0F;  ///< 0 if fresh, 1 if gone
};

/// A painted area: a zebra bar, stop line, arrow or symbol.
struct PaintArea {
  Ring ring;
  Rgb albedo{0.8F, 0.8F, 0.8F};
  float wear = 0.0F;
};

/// The shadow of something outside of the world. It darkens road and paint alike.
struct Shade {
  Ring ring;
  float light = 0.5F;  ///< share of the light that remains
};

enum class WallTexture : uint8_t {
  kKerbPlain,
  kKerbStriped,
  kKerbPainted,
  kConcreteBarrier,
  kGuardRail,
  kHedge,
  kStoneWall,
  kFence,
  kFacade,
};

/// A vertical surface on a polyline, visible from both sides. The face of a kerb is a wall; its top
/// belongs to the ground.
struct Wall {
  Polyline base;
  double bottom_m = 0.0;
  double top_m = 0.0;
  WallTexture texture = WallTexture::kStoneWall;
  Rgb albedo{0.5F, 0.5F, 0.5F};
  uint32_t seed = 0;
};

enum class VehicleKind : uint8_t { kCar, kVan, kTruck, kBus };

/// A parked or moving vehicle. It hides what is behind it and casts a soft shadow.
struct VehicleBody {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
  double height_m = 1.5;
  VehicleKind kind = VehicleKind::kCar;
  Rgb albedo{0.5F, 0.5F, 0.5F};

  /// The body frame has x forward, y to the left and its origin at the centre.
  Se2 map_from_body() const { return {centre.x(), centre.y(), yaw_rad}; }
};

enum class PostKind : uint8_t { kPole, kSign, kTreeTrunk, kTreeCrown };

/// An upright round body, drawn as a panel that always faces the camera.
struct Post {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double radius_m = 0.1;
  double bottom_m = 0.0;
  double top_m = 4.0;
  PostKind kind = PostKind::kPole;
  Rgb albedo{0.4F, 0.4F, 0.4F};
  uint32_t seed = 0;
};

/// A moving vehicle. It drives along its path; at the end it starts again at the beginning.
struct TrafficVehicle {
  VehicleBody body;  ///< its centre and yaw are computed from the path
  Polyline path;
  double start_m = 0.0;
  double speed_mps = 10.0;
};

class PhotoLibrary;

/// The moving vehicles at their places after `seconds` of simulated time.
std::vector<VehicleBody> traffic_at(const std::vector<TrafficVehicle>& traffic, double seconds);

struct World {
  uint64_t seed = 0;
  /// The HD map for the localizer. Some painted lines may be missing in it, and some of its lines
  /// may not exist on the road.
  HdMap map;
  GroundMaterial background = GroundMaterial::kGrass;
  std::vector<Surface> surfaces;
  std::vector<PaintLine> paint_lines;
  std::vector<PaintArea> paint_areas;
  std::vector<Shade> shades;
  std::vector<Wall> walls;
  std::vector<VehicleBody> parked;
  std::vector<TrafficVehicle> traffic;
  std::vector<Post> posts;
  /// Photographs of surfaces (sim/render/photo_library.h), which must outlive the world. If null,
  /// all textures are the simulator's own.
  const PhotoLibrary* photos = nullptr;
};

}  // namespace bevloc::sim
