#include "sim/world/scenery.h"

#include <algorithm>
#include <cmath>

#include "sim/world/ground_mask.h"

namespace bevloc::sim {
namespace {

Rgb tinted(Random& random, double low, double high, double tint) {
  const double value = random.uniform(low, high);
  const auto channel = [&] {
    return static_cast<float>(std::clamp(value + random.uniform(-tint, tint), 0.03, 0.95));
  };
  const float r = channel();
  const float g = channel();
  const float b = channel();
  return {r, g, b};
}

class Scenery {
 public:
  Scenery(const std::vector<Polyline>& keep_off, WorldBuilder& builder)
      : builder_(builder), random_(builder.random()), mask_(builder.paved_rings()) {
    for (const Polyline& line : keep_off) mask_.occupy_line(line);
  }

  void line_roadside(const Roadside& roadside) {
    const Path edge(roadside.edge);
    if (edge.length_m() < 8.0) return;
    add_houses(edge, roadside.clear_m);
    add_fences(edge, roadside.clear_m);
    add_posts(edge, roadside.clear_m);
    add_tree_row(edge, roadside.clear_m);
  }

  void scatter_trees();

 private:
  void add_houses(const Path& edge, double clear_m);
  void add_fences(const Path& edge, double clear_m);
  void add_posts(const Path& edge, double clear_m);
  void add_tree_row(const Path& edge, double clear_m);
  void add_tree(const Eigen::Vector2d& position);
  void add_sign(const Eigen::Vector2d& position);
  void add_lamp(const Eigen::Vector2d& position, double height_m);
  uint32_t post_seed() { return static_cast<uint32_t>(random_.bits()); }

  WorldBuilder& builder_;
  Random& random_;
  GroundMask mask_;
};

void Scenery::add_houses(const Path& edge, double clear_m) {
  const double urbanity = builder_.town().urbanity;
  const double house_chance = 0.15 + 0.8 * urbanity;
  double station_m = random_.uniform(0.0, 10.0);
  while (station_m < edge.length_m()) {
    const double width_m = random_.uniform(8.0, 18.0 + 18.0 * urbanity);
    const double depth_m = random_.uniform(7.0, 14.0);
    const double set_back_m = clear_m + random_.uniform(3.0, 15.0 - 9.0 * urbanity);
    const double height_m = random_.uniform(4.0, 7.0 + 8.0 * urbanity);
    const bool wanted = random_.chance(house_chance);
    const double middle_m = station_m + 0.5 * width_m;
    station_m += width_m + random_.uniform(0.0, 16.0 - 14.0 * urbanity);
    if (!wanted || middle_m > edge.length_m()) continue;
    const Eigen::Vector2d forward = edge.direction(middle_m);
    const Eigen::Vector2d right = -left_of(forward);
    const Eigen::Vector2d front = edge.position(middle_m) + set_back_m * right;
    const Ring outline{front - 0.5 * width_m * forward, front + 0.5 * width_m * forward,
                       front + 0.5 * width_m * forward + depth_m * right,
                       front - 0.5 * width_m * forward + depth_m * right};
    if (!mask_.is_free(outline)) continue;
    mask_.occupy(outline);
    Polyline base = outline;
    base.push_back(base.front());
    builder_.add_wall(base, WallTexture::kFacade, 0.0, height_m, tinted(random_, 0.25, 0.75, 0.1));
  }
}

void Scenery::add_fences(const Path& edge, double clear_m) {
  double station_m = random_.uniform(0.0, 15.0);
  const double fence_chance = random_.uniform(0.0, 0.7);
  while (station_m + 5.0 < edge.length_m()) {
    const double end_m = std::min(edge.length_m(), station_m + random_.uniform(6.0, 35.0));
    const double offset_m = clear_m + random_.uniform(0.4, 2.5);
    const bool wanted = random_.chance(fence_chance);
    const double kind = random_.uniform();
    const double height_m = random_.uniform(0.6, 2.2);
    const Polyline line = edge.parallel(station_m, end_m, offset_m);
    station_m = end_m + random_.uniform(0.0, 12.0);
    if (!wanted || !mask_.is_free(line)) continue;
    if (kind < 0.4) {
      builder_.add_wall(line, WallTexture::kHedge, 0.0, height_m, {0.12F, 0.24F, 0.08F});
    } else if (kind < 0.7) {
      builder_.add_wall(line, WallTexture::kFence, 0.0, height_m, tinted(random_, 0.1, 0.7, 0.1));
    } else {
      builder_.add_wall(line, WallTexture::kStoneWall, 0.0, height_m,
                        tinted(random_, 0.2, 0.65, 0.05));
    }
  }
}

void Scenery::add_lamp(const Eigen::Vector2d& position, double height_m) {
  builder_.world().posts.push_back({.position = position,
                                    .radius_m = random_.uniform(0.05, 0.12),
                                    .top_m = height_m,
                                    .kind = PostKind::kPole,
                                    .albedo = tinted(random_, 0.15, 0.6, 0.03),
                                    .seed = post_seed()});
}

void Scenery::add_sign(const Eigen::Vector2d& position) {
  const double top_m = random_.uniform(2.2, 3.0);
  const double half_m = random_.uniform(0.25, 0.4);
  builder_.world().posts.push_back({.position = position,
                                    .radius_m = 0.04,
                                    .top_m = top_m - 2.0 * half_m,
                                    .kind = PostKind::kPole,
                                    .albedo = {0.5F, 0.5F, 0.5F},
                                    .seed = post_seed()});
  builder_.world().posts.push_back({.position = position,
                                    .radius_m = half_m,
                                    .bottom_m = top_m - 2.0 * half_m,
                                    .top_m = top_m,
                                    .kind = PostKind::kSign,
                                    .albedo = tinted(random_, 0.3, 0.7, 0.3),
                                    .seed = post_seed()});
}

void Scenery::add_posts(const Path& edge, double clear_m) {
  const double spacing_m = random_.uniform(18.0, 45.0);
  const double lamp_m = random_.uniform(4.0, 9.0);
  const double offset_m = clear_m > 1.0 ? random_.uniform(0.4, 0.9) : clear_m + 1.0;
  for (double s = random_.uniform(2.0, spacing_m); s < edge.length_m(); s += spacing_m) {
    if (random_.chance(0.7)) add_lamp(edge.beside(s, offset_m), lamp_m);
    if (random_.chance(0.25)) add_sign(edge.beside(s + random_.uniform(2.0, 10.0), offset_m));
  }
}

void Scenery::add_tree(const Eigen::Vector2d& position) {
  const double trunk_m = random_.uniform(1.6, 3.5);
  const double crown_m = random_.uniform(1.2, 3.2);
  builder_.world().posts.push_back({.position = position,
                                    .radius_m = random_.uniform(0.08, 0.3),
                                    .top_m = trunk_m,
                                    .kind = PostKind::kTreeTrunk,
                                    .albedo = tinted(random_, 0.1, 0.3, 0.03),
                                    .seed = post_seed()});
  const double green = random_.uniform(0.1, 0.32);
  builder_.world().posts.push_back(
      {.position = position,
       .radius_m = crown_m,
       .bottom_m = 0.85 * trunk_m,
       .top_m = 0.85 * trunk_m + random_.uniform(1.6, 2.6) * crown_m,
       .kind = PostKind::kTreeCrown,
       .albedo = {static_cast<float>(green * random_.uniform(0.5, 1.1)), static_cast<float>(green),
                  static_cast<float>(0.35 * green)},
       .seed = post_seed()});
}

void Scenery::add_tree_row(const Path& edge, double clear_m) {
  const bool wanted = random_.chance(0.6 * builder_.town().tree_density);
  const double spacing_m = random_.uniform(7.0, 20.0);
  const double offset_m = clear_m + random_.uniform(1.0, 4.0);
  if (!wanted) return;
  for (double s = 0.5 * spacing_m; s < edge.length_m(); s += spacing_m) {
    const Eigen::Vector2d position = edge.beside(s, offset_m);
    if (random_.chance(0.85) && mask_.is_free({position})) add_tree(position);
  }
}

void Scenery::scatter_trees() {
  const Eigen::Vector2d low = mask_.min_corner();
  const Eigen::Vector2d high = mask_.max_corner();
  const double area_m2 = (high - low).prod();
  const int attempts = static_cast<int>(0.0015 * area_m2 * builder_.town().tree_density);
  for (int i = 0; i < attempts; ++i) {
    const double y_m = random_.uniform(low.y(), high.y());
    const double x_m = random_.uniform(low.x(), high.x());
    const Eigen::Vector2d position(x_m, y_m);
    const double distance_m = mask_.distance_to_paved_m(position);
    if (distance_m < 2.0 || distance_m > 30.0 || !mask_.is_free({position})) continue;
    add_tree(position);
  }
}

}  // namespace

void add_scenery(const std::vector<Roadside>& roadsides, const std::vector<Polyline>& keep_off,
                 WorldBuilder& builder) {
  Scenery scenery(keep_off, builder);
  for (const Roadside& roadside : roadsides) scenery.line_roadside(roadside);
  scenery.scatter_trees();
}

}  // namespace bevloc::sim
