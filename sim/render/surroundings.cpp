#include "sim/render/surroundings.h"

#include <cmath>

namespace bevloc::sim {
namespace {

constexpr double kLongestPieceM = 10.0;
constexpr double kLowWallM = 0.3;  ///< lower walls (kerbs) are drawn at half of the distance only

Box box_around(const Eigen::Vector2d& centre, double reach_m) {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(reach_m);
  return {centre - reach, centre + reach};
}

/// Whether a body overlaps the own vehicle (about 4.6 m x 1.9 m, its middle 1.4 m ahead of the rear
/// axle).
bool overlaps_vehicle(const VehicleBody& body, const Se2& map_from_vehicle) {
  const Eigen::Vector2d middle = map_from_vehicle * Eigen::Vector2d(1.4, 0.0);
  const Eigen::Vector2d offset = body.map_from_body().inverse() * middle;
  return std::abs(offset.x()) < 0.5 * body.length_m + 2.8 &&
         std::abs(offset.y()) < 0.5 * body.width_m + 1.0;
}

}  // namespace

SceneIndex::SceneIndex(const World& world) : world_(world) {
  cut_walls();
  std::vector<Box> boxes;
  for (const WallPiece& piece : pieces_) {
    boxes.emplace_back(piece.from.cwiseMin(piece.to), piece.from.cwiseMax(piece.to));
  }
  piece_index_ = CellIndex(boxes);
  boxes.clear();
  for (const Post& post : world_.posts) boxes.push_back(box_around(post.position, post.radius_m));
  post_index_ = CellIndex(boxes);
  boxes.clear();
  for (const VehicleBody& body : world_.parked) {
    boxes.push_back(box_around(body.centre, 0.5 * body.length_m));
  }
  parked_index_ = CellIndex(boxes);
}

void SceneIndex::cut_walls() {
  for (const Wall& wall : world_.walls) {
    double start_m = 0.0;
    for (size_t i = 1; i < wall.base.size(); ++i) {
      const Eigen::Vector2d edge = wall.base[i] - wall.base[i - 1];
      const double length_m = edge.norm();
      if (length_m < 1e-3) continue;
      const int parts = static_cast<int>(std::ceil(length_m / kLongestPieceM));
      for (int part = 0; part < parts; ++part) {
        const double begin = static_cast<double>(part) / parts;
        const double end = static_cast<double>(part + 1) / parts;
        pieces_.push_back({wall.base[i - 1] + begin * edge, wall.base[i - 1] + end * edge,
                           start_m + begin * length_m, &wall});
      }
      start_m += length_m;
    }
  }
}

void SceneIndex::gather(const Se2& map_from_vehicle, double time_s, double radius_m,
                        Surroundings& surroundings) {
  const Eigen::Vector2d centre = map_from_vehicle.translation();
  const Box wide = box_around(centre, radius_m);
  const Box close = box_around(centre, 0.5 * radius_m);
  surroundings = {};
  surroundings.photos = world_.photos;
  found_.clear();
  piece_index_.query(wide, found_);
  for (const int item : found_) {
    const WallPiece& piece = pieces_[static_cast<size_t>(item)];
    const bool low = piece.wall->top_m < kLowWallM;
    if (!low || close.contains(piece.from)) surroundings.walls.push_back(&piece);
  }
  found_.clear();
  post_index_.query(wide, found_);
  for (const int item : found_)
    surroundings.posts.push_back(&world_.posts[static_cast<size_t>(item)]);
  found_.clear();
  parked_index_.query(wide, found_);
  for (const int item : found_) {
    const VehicleBody& body = world_.parked[static_cast<size_t>(item)];
    if (!overlaps_vehicle(body, map_from_vehicle)) surroundings.parked.push_back(body);
  }
  for (const VehicleBody& body : traffic_at(world_.traffic, time_s)) {
    if (wide.contains(body.centre) && !overlaps_vehicle(body, map_from_vehicle)) {
      surroundings.traffic.push_back(body);
    }
  }
}

}  // namespace bevloc::sim
