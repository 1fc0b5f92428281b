#include "sim/samples/street_clutter.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"
#include "sim/world/path.h"
#include "sim/world/road_side.h"

namespace bevloc::sim {
namespace {

constexpr Rgb kWhite{0.75F, 0.75F, 0.75F};
constexpr Rgb kClutterYellow{0.72F, 0.52F, 0.08F};
constexpr Rgb kRed{0.5F, 0.06F, 0.04F};
constexpr Rgb kOrange{0.7F, 0.2F, 0.03F};

/// Shorter lines and lanes stay as they are.
constexpr double kShortest_m = 8.0;
constexpr double kHalfLane_m = 1.6;

Rgb random_colour(Random& random) {
  const auto channel = [&random] { return static_cast<float>(random.uniform(0.02, 0.6)); };
  return {channel(), channel(), channel()};
}

/// Adds everything along one boundary. `outside` is the sign of the side without the road for
/// Path::beside().
class BoundaryClutter {
 public:
  BoundaryClutter(const Path& path, double outside, Random& random, World& world)
      : path_(path), outside_(outside), random_(random), world_(world) {}

  void add(const StreetClutter& clutter) {
    if (random_.chance(clutter.kerb_line)) paint_lines();
    if (random_.chance(clutter.bollards)) set_bollards();
    if (random_.chance(clutter.railing)) set_railing();
    const double expected = clutter.people_per_100m * path_.length_m() / 100.0;
    for (double left = expected; left > 0.0; left -= 1.0) {
      if (random_.chance(std::min(left, 1.0))) set_person();
    }
  }

 private:
  Polyline line_outside(double distance_m) const {
    return path_.parallel(0.0, path_.length_m(), outside_ * distance_m);
  }

  void paint_lines() {
    const Rgb albedo = random_.chance(0.5) ? kClutterYellow : kWhite;
    const double width_m = random_.uniform(0.06, 0.12);
    const double inset_m = random_.uniform(0.12, 0.45);
    const auto wear = static_cast<float>(random_.uniform(0.0, 0.6));
    const int lines = random_.chance(0.5) ? 2 : 1;
    for (int i = 0; i < lines; ++i) {
      world_.paint_lines.push_back({.points = line_outside(-inset_m - 2.2 * i * width_m),
                                    .width_m = width_m,
                                    .albedo = albedo,
                                    .wear = wear});
    }
  }

  void set_bollards() {
    const double spacing_m = random_.uniform(1.5, 4.0);
    const double distance_m = random_.uniform(0.15, 0.6);
    const double height_m = random_.uniform(0.6, 1.1);
    const Rgb albedo = random_colour(random_);
    for (double s = 0.5 * spacing_m; s < path_.length_m(); s += spacing_m) {
      world_.posts.push_back({.position = path_.beside(s, outside_ * distance_m),
                              .radius_m = 0.07,
                              .top_m = height_m,
                              .albedo = albedo});
    }
  }

  void set_railing() {
    const bool guard = random_.chance(0.5);
    world_.walls.push_back({.base = line_outside(random_.uniform(0.2, 0.9)),
                            .top_m = random_.uniform(0.7, 1.2),
                            .texture = guard ? WallTexture::kGuardRail : WallTexture::kFence,
                            .albedo = random_colour(random_),
                            .seed = static_cast<uint32_t>(random_.integer(0, 1 << 20))});
  }

  /// Adds a person on the pavement or on the road, or a cyclist, whose lower half is broader.
  void set_person() {
    const double station_m = random_.uniform(0.0, path_.length_m());
    const Eigen::Vector2d foot = path_.beside(station_m, outside_ * random_.uniform(-2.0, 4.0));
    const bool rides = random_.chance(0.25);
    const double hip_m = rides ? 1.0 : 0.85;
    const double shoulder_m = hip_m + 0.6;
    const auto stack = [&](double radius_m, double bottom_m, double top_m, const Rgb& albedo) {
      world_.posts.push_back({.position = foot,
                              .radius_m = radius_m,
                              .bottom_m = bottom_m,
                              .top_m = top_m,
                              .albedo = albedo});
    };
    stack(rides ? 0.3 : 0.15, 0.0, hip_m, random_colour(random_));
    stack(0.23, hip_m, shoulder_m, random_colour(random_));
    stack(0.1, shoulder_m, shoulder_m + 0.25, {0.35F, 0.24F, 0.18F});
  }

  const Path& path_;
  double outside_;
  Random& random_;
  World& world_;
};

void clutter_boundaries(const StreetClutter& clutter, Random& random, World& world) {
  for (const RoadsideBoundary& boundary : boundaries_beside_road(world.map, kShortest_m)) {
    const double outside = boundary.side.is_right ? -1.0 : 1.0;
    BoundaryClutter(boundary.path, outside, random, world).add(clutter);
  }
}

/// Replaces the dashes of some lines by raised dots.
void replace_dashes(double share, Random& random, World& world) {
  for (PaintLine& line : world.paint_lines) {
    if (line.dash_m <= 0.0 || !random.chance(share)) continue;
    line.dash_m = 0.1;
    line.gap_m = random.uniform(0.5, 2.0);
    line.width_m = 0.1;
  }
}

/// Adds lines along the two longest edges of some crossings.
void edge_crossings(double share, Random& random, World& world) {
  for (const MapElement& element : world.map.elements) {
    if (element.element_class != ElementClass::kPedestrianCrossing) continue;
    if (element.points.size() != 4 || !random.chance(share)) continue;
    const Ring& ring = element.points;
    const bool first_is_longer = (ring[1] - ring[0]).norm() > (ring[2] - ring[1]).norm();
    const double width_m = random.uniform(0.1, 0.4);
    for (const size_t i : {size_t{0}, size_t{2}}) {
      const size_t from = first_is_longer ? i : i + 1;
      world.paint_lines.push_back({.points = {ring[from], ring[(from + 1) % 4]},
                                   .width_m = width_m,
                                   .albedo = kWhite,
                                   .wear = static_cast<float>(random.uniform(0.0, 0.5))});
    }
  }
}

/// A stretch of a lane.
struct Stretch {
  const Path& path;
  double from_m;
  double to_m;
};

/// Paints a box with diagonals in one or both directions.
void paint_box(const Stretch& stretch, Random& random, World& world) {
  const Rgb albedo = random.chance(0.6) ? kClutterYellow : kWhite;
  const double spacing_m = random.uniform(0.8, 2.0);
  const auto wear = static_cast<float>(random.uniform(0.0, 0.6));
  const auto stroke = [&](double from_m, double from_right_m, double to_m, double to_right_m) {
    world.paint_lines.push_back({.points = {stretch.path.beside(from_m, from_right_m),
                                            stretch.path.beside(to_m, to_right_m)},
                                 .width_m = random.uniform(0.08, 0.2),
                                 .albedo = albedo,
                                 .wear = wear});
  };
  const double half = 0.85 * kHalfLane_m;
  for (const double right_m : {-half, half}) {
    stroke(stretch.from_m, right_m, stretch.to_m, right_m);
  }
  const bool crossed = random.chance(0.5);
  for (double s = stretch.from_m; s + 2.0 * half < stretch.to_m; s += spacing_m) {
    stroke(s, -half, s + 2.0 * half, half);
    if (crossed) stroke(s, half, s + 2.0 * half, -half);
  }
}

/// Adds cones beside a lane's middle, and a board across the start.
void set_works(const Stretch& stretch, Random& random, World& world) {
  const double side = random.chance(0.5) ? 1.0 : -1.0;
  const double right_m = side * random.uniform(0.3, 1.0) * kHalfLane_m;
  for (double s = stretch.from_m; s < stretch.to_m; s += random.uniform(1.5, 4.0)) {
    world.posts.push_back({.position = stretch.path.beside(s, right_m),
                           .radius_m = 0.13,
                           .top_m = random.uniform(0.5, 0.9),
                           .albedo = kOrange});
  }
  world.walls.push_back({.base = {stretch.path.beside(stretch.from_m, right_m),
                                  stretch.path.beside(stretch.from_m, side * kHalfLane_m)},
                         .bottom_m = 0.5,
                         .top_m = 1.0,
                         .texture = WallTexture::kKerbStriped,
                         .albedo = random.chance(0.5) ? kRed : kWhite});
}

/// Adds the shadow of a house or a bridge, which is a band across the road at any angle, or the
/// patches of a tree's shadow.
void cast_shadow(const Stretch& stretch, Random& random, World& world) {
  constexpr double kReach_m = 25.0;
  const auto light = static_cast<float>(random.uniform(0.2, 0.7));
  const Eigen::Vector2d centre = stretch.path.position(stretch.from_m);
  if (random.chance(0.3)) {
    const int patches = random.integer(5, 25);
    for (int i = 0; i < patches; ++i) {
      const double y_m = random.uniform(-5.0, 5.0);
      const double x_m = random.uniform(-5.0, 5.0);
      const Eigen::Vector2d place = centre + Eigen::Vector2d(x_m, y_m);
      Ring ring;
      for (int corner = 0; corner < 7; ++corner) {
        ring.emplace_back(place + random.uniform(0.2, 1.0) *
                                      unit_vector(corner * 2.0 * std::numbers::pi / 7.0));
      }
      world.shades.push_back({std::move(ring), light});
    }
    return;
  }
  const Eigen::Vector2d along =
      unit_vector(stretch.path.heading_rad(stretch.from_m) + random.uniform(0.0, std::numbers::pi));
  const Eigen::Vector2d half_length = random.uniform(4.0, kReach_m) * along;
  const Eigen::Vector2d half_width = random.uniform(0.4, 8.0) * left_of(along);
  world.shades.push_back({{centre - half_length - half_width, centre + half_length - half_width,
                           centre + half_length + half_width, centre - half_length + half_width},
                          light});
}

void clutter_lanes(const StreetClutter& clutter, Random& random, World& world) {
  for (const Lane& lane : world.map.lanes) {
    const bool box = random.chance(clutter.box);
    const bool works = random.chance(clutter.works);
    const bool shadow = random.chance(clutter.shadow);
    if (polyline_length(lane.centerline) < kShortest_m) continue;
    const Path path(lane.centerline);
    const double from_m = random.uniform(0.0, path.length_m() - 0.5 * kShortest_m);
    const double to_m = std::min(path.length_m(), from_m + random.uniform(4.0, 25.0));
    const Stretch stretch{path, from_m, to_m};
    if (box) paint_box(stretch, random, world);
    if (works) set_works(stretch, random, world);
    if (shadow) cast_shadow(stretch, random, world);
  }
}

}  // namespace

StreetClutter scaled(const StreetClutter& clutter, double factor) {
  const auto share = [factor](double value) { return std::min(1.0, factor * value); };
  return {.kerb_line = share(clutter.kerb_line),
          .studs = share(clutter.studs),
          .crossing_edges = share(clutter.crossing_edges),
          .box = share(clutter.box),
          .works = share(clutter.works),
          .bollards = share(clutter.bollards),
          .railing = share(clutter.railing),
          .shadow = share(clutter.shadow),
          .people_per_100m = factor * clutter.people_per_100m};
}

void add_clutter(const StreetClutter& clutter, uint64_t seed, World& world) {
  if (clutter == StreetClutter{}) return;
  Random random(seed_for(seed, "clutter"));
  clutter_boundaries(clutter, random, world);
  replace_dashes(clutter.studs, random, world);
  edge_crossings(clutter.crossing_edges, random, world);
  clutter_lanes(clutter, random, world);
}

}  // namespace bevloc::sim
