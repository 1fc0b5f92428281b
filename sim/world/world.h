// Everything the simulated cameras can see, as plain geometry in the map frame.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pipeline/map/hd_map.h"

namespace bevloc::sim {

using Polyline = std::vector<Eigen::Vector2d>;
using Ring = std::vector<Eigen::Vector2d>;

struct Rgb {
  float r = 0.0F;
  float g = 0.0F;
  float b = 0.0F;
};

enum class GroundMaterial : uint8_t { kAsphalt, kConcrete, kPaving, kGrass, kDirt, kGravel };

/// A patch of ground. Painter's order: a later surface covers an earlier one.
struct Surface {
  GroundMaterial material = GroundMaterial::kAsphalt;
  float brightness = 1.0F;  ///< of this patch against the material's usual albedo
  Ring ring;
};

/// A painted line; dash_m = 0 means solid.
struct PaintLine {
  Polyline points;
  double width_m = 0.12;
  double dash_m = 0.0;
  double gap_m = 0.0;
  double phase_m = 0.0;
  Rgb albedo{0.8F, 0.8F, 0.8F};
  float wear = 0.0F;  ///< 0 fresh to 1 gone
};

/// A painted area: zebra bar, stop line, arrow, symbol.
struct PaintArea {
  Ring ring;
  Rgb albedo{0.8F, 0.8F, 0.8F};
  float wear = 0.0F;
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

/// A vertical sheet standing on a polyline, seen from both sides. A kerb's top is part of the
/// ground texture; its face is a wall.
struct Wall {
  Polyline base;
  double bottom_m = 0.0;
  double top_m = 0.0;
  WallTexture texture = WallTexture::kStoneWall;
  Rgb albedo{0.5F, 0.5F, 0.5F};
  uint32_t seed = 0;
};

enum class VehicleKind : uint8_t { kCar, kVan, kTruck, kBus };

/// A parked or moving vehicle: it occludes and throws a soft shadow.
struct VehicleBody {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double length_m = 4.5;
  double width_m = 1.8;
  double height_m = 1.5;
  VehicleKind kind = VehicleKind::kCar;
  Rgb albedo{0.5F, 0.5F, 0.5F};
};

enum class PostKind : uint8_t { kPole, kSign, kTreeTrunk, kTreeCrown };

/// An upright body of revolution, drawn as a sheet that always faces the camera.
struct Post {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double radius_m = 0.1;
  double bottom_m = 0.0;
  double top_m = 4.0;
  PostKind kind = PostKind::kPole;
  Rgb albedo{0.4F, 0.4F, 0.4F};
  uint32_t seed = 0;
};

/// A moving vehicle: it drives along a lane path for ever, there and round again.
struct TrafficVehicle {
  VehicleBody body;  ///< centre and yaw are overwritten from the path
  Polyline path;
  double start_m = 0.0;
  double speed_mps = 10.0;
};

/// Where the traffic stands after `seconds` of simulated time.
std::vector<VehicleBody> traffic_at(const std::vector<TrafficVehicle>& traffic, double seconds);

struct World {
  uint64_t seed = 0;
  /// The HD map that the localizer is given. It may miss some of the paint and carry some lines
  /// that are not on the road.
  HdMap map;
  GroundMaterial background = GroundMaterial::kGrass;
  std::vector<Surface> surfaces;
  std::vector<PaintLine> paint_lines;
  std::vector<PaintArea> paint_areas;
  std::vector<Wall> walls;
  std::vector<VehicleBody> parked;
  std::vector<TrafficVehicle> traffic;
  std::vector<Post> posts;
};

}  // namespace bevloc::sim
