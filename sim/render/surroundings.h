// Finds the walls, posts and vehicles around the own vehicle at one moment.
#pragma once

#include <vector>

#include "common/se2.h"
#include "sim/render/cell_index.h"
#include "sim/world/world.h"

namespace bevloc::sim {

/// A straight piece of a wall, short enough to sort pieces by distance.
struct WallPiece {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double start_m = 0.0;  ///< arc length of `from` along the wall
  const Wall* wall = nullptr;
};

/// The pointers refer to the SceneIndex and its world.
struct Surroundings {
  std::vector<const WallPiece*> walls;
  std::vector<const Post*> posts;
  std::vector<VehicleBody> parked;
  std::vector<VehicleBody> traffic;
  const PhotoLibrary* photos = nullptr;  ///< World::photos
};

/// A spatial index of the walls, posts and vehicles of a world. The world must outlive the index.
/// One thread.
class SceneIndex {
 public:
  explicit SceneIndex(const World& world);

  /// Overwrites `surroundings` with everything within `radius_m` of the vehicle (kerbs: within half
  /// of it). `time_s` places the traffic. Vehicles that overlap the own vehicle are left out.
  void gather(const Se2& map_from_vehicle, double time_s, double radius_m,
              Surroundings& surroundings);

 private:
  void cut_walls();

  const World& world_;
  std::vector<WallPiece> pieces_;
  CellIndex piece_index_;
  CellIndex post_index_;
  CellIndex parked_index_;
  std::vector<int> found_;
};

}  // namespace bevloc::sim
