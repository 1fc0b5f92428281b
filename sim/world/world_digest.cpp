#include "sim/world/world_digest.h"

#include "sim/digest.h"

namespace bevloc::sim {
namespace {

void add(Digest& digest, const Rgb& colour) {
  for (const float part : {colour.r, colour.g, colour.b}) digest.add(part);
}

void add(Digest& digest, const std::vector<Eigen::Vector2d>& points) {
  digest.add(points.size());
  for (const Eigen::Vector2d& point : points) {
    digest.add(point.x());
    digest.add(point.y());
  }
}

void add(Digest& digest, const VehicleBody& body) {
  for (const double part : {body.centre.x(), body.centre.y(), body.yaw_rad, body.length_m,
                            body.width_m, body.height_m}) {
    digest.add(part);
  }
  digest.add(body.kind);
  add(digest, body.albedo);
}

void add_ground(Digest& digest, const World& world) {
  digest.add(world.background);
  for (const Surface& surface : world.surfaces) {
    digest.add(surface.material);
    digest.add(surface.brightness);
    add(digest, surface.ring);
  }
  for (const PaintLine& line : world.paint_lines) {
    for (const double part : {line.width_m, line.dash_m, line.gap_m, line.phase_m}) {
      digest.add(part);
    }
    digest.add(line.wear);
    add(digest, line.albedo);
    add(digest, line.points);
  }
  for (const PaintArea& area : world.paint_areas) {
    digest.add(area.wear);
    add(digest, area.albedo);
    add(digest, area.ring);
  }
  for (const Shade& shade : world.shades) {
    digest.add(shade.light);
    add(digest, shade.ring);
  }
}

void add_upright(Digest& digest, const World& world) {
  for (const Wall& wall : world.walls) {
    digest.add(wall.bottom_m);
    digest.add(wall.top_m);
    digest.add(wall.texture);
    digest.add(wall.seed);
    add(digest, wall.albedo);
    add(digest, wall.base);
  }
  for (const Post& post : world.posts) {
    for (const double part :
         {post.position.x(), post.position.y(), post.radius_m, post.bottom_m, post.top_m}) {
      digest.add(part);
    }
    digest.add(post.kind);
    digest.add(post.seed);
    add(digest, post.albedo);
  }
  for (const VehicleBody& body : world.parked) add(digest, body);
  for (const TrafficVehicle& vehicle : world.traffic) {
    digest.add(vehicle.start_m);
    digest.add(vehicle.speed_mps);
    add(digest, vehicle.body);
    add(digest, vehicle.path);
  }
}

}  // namespace

uint64_t digest_of(const World& world) {
  Digest digest;
  digest.add(world.seed);
  add_ground(digest, world);
  add_upright(digest, world);
  return digest.value();
}

}  // namespace bevloc::sim
