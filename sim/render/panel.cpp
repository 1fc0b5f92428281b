#include "sim/render/panel.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"
#include "sim/render/photo_library.h"
#include "sim/render/vehicle_profile.h"

namespace bevloc::sim {
namespace {

constexpr float kStoreyM = 3.2F;

/// Sets the texture coordinates so that the texture repeats or stretches over the panel.
void fit_texture(Panel& panel, double start_m) {
  const Texture& texture = panel.texture();
  const bool repeats_u = texture.period_u_m > 0.0F;
  panel.u_per_m = 1.0F / (repeats_u ? texture.period_u_m : panel.length_m);
  panel.v_per_m = 1.0F / (texture.period_v_m > 0.0F ? texture.period_v_m : panel.height_m);
  if (panel.pattern == Pattern::kFacade) {
    // Round to whole storeys, so that no roof cuts through a window. A photograph has storeys of
    // its own.
    const float storey_m = panel.photo != nullptr ? texture.period_v_m : kStoreyM;
    const float storeys = std::max(1.0F, std::round(panel.height_m / storey_m));
    const float in_period = panel.photo != nullptr ? 1.0F : static_cast<float>(kFacadeStoreys);
    panel.v_per_m = storeys / (in_period * panel.height_m);
  }
  panel.u_start =
      repeats_u ? static_cast<float>(std::fmod(start_m, texture.period_u_m)) * panel.u_per_m : 0.0F;
}

Pattern pattern_of(PostKind kind) {
  switch (kind) {
    case PostKind::kSign:
      return Pattern::kSign;
    case PostKind::kTreeCrown:
      return Pattern::kCrown;
    case PostKind::kPole:
    case PostKind::kTreeTrunk:
      break;
  }
  return Pattern::kCylinder;
}

}  // namespace

const std::vector<Panel>& PanelBuilder::build(const Eigen::Vector3d& camera,
                                              const CurvedGround& ground,
                                              const Surroundings& surroundings) {
  photos_ = surroundings.photos;
  camera_ = camera;
  ground_ = ground;
  unsorted_.clear();
  for (const WallPiece* piece : surroundings.walls) add_wall(*piece);
  for (const Post* post : surroundings.posts) add_post(*post);
  for (const VehicleBody& body : surroundings.parked) add_vehicle(body, false);
  for (const VehicleBody& body : surroundings.traffic) add_vehicle(body, true);
  order_.clear();
  for (size_t i = 0; i < unsorted_.size(); ++i) {
    const Panel& s = unsorted_[i];
    const Eigen::Vector3f middle = s.corner + 0.5F * (s.length_m * s.along + s.height_m * s.up);
    order_.emplace_back(-middle.squaredNorm(), static_cast<int>(i));
  }
  std::sort(order_.begin(), order_.end());
  panels_.clear();
  for (const auto& [distance, item] : order_) {
    panels_.push_back(unsorted_[static_cast<size_t>(item)]);
  }
  return panels_;
}

void PanelBuilder::add_wall(const WallPiece& piece) {
  const Wall& wall = *piece.wall;
  Panel panel;
  panel.corner = from_camera(piece.from, wall.bottom_m, piece.from);
  const Eigen::Vector3f base = from_camera(piece.to, wall.bottom_m, piece.to) - panel.corner;
  panel.length_m = base.norm();
  panel.height_m = static_cast<float>(wall.top_m - wall.bottom_m);
  if (panel.height_m <= 0.0F) return;
  panel.along = base.normalized();
  // A wall on a slope leans along its own line.
  panel.up = (Eigen::Vector3f::UnitZ() - panel.along.z() * panel.along).normalized();
  panel.pattern = pattern_of(wall.texture);
  panel.tint = wall.albedo;
  panel.softness = wall.texture == WallTexture::kHedge ? 0.7F : 0.0F;
  panel.glows = wall.texture == WallTexture::kFacade;
  if (photos_ != nullptr) panel.photo = photos_->wall(wall.texture, wall.seed);
  // The seed shifts the texture, so that walls of one kind differ.
  const double shift_m = static_cast<double>(mix_seed(wall.seed) % 4096U) * 0.05;
  fit_texture(panel, piece.start_m + shift_m);
  unsorted_.push_back(panel);
}

void PanelBuilder::add_post(const Post& post) {
  const Eigen::Vector2d to_post = post.position - camera_.head<2>();
  const double distance_m = to_post.norm();
  if (distance_m < post.radius_m + 0.2 || post.top_m <= post.bottom_m) return;
  const Eigen::Vector2d across(to_post.y() / distance_m, -to_post.x() / distance_m);
  Panel panel;
  panel.corner = from_camera(post.position - post.radius_m * across, post.bottom_m, post.position);
  panel.along = {static_cast<float>(across.x()), static_cast<float>(across.y()), 0.0F};
  panel.length_m = static_cast<float>(2.0 * post.radius_m);
  panel.height_m = static_cast<float>(post.top_m - post.bottom_m);
  panel.pattern = pattern_of(post.kind);
  panel.tint = post.albedo;
  panel.softness = post.kind == PostKind::kTreeCrown ? 0.8F : 0.4F;
  if (photos_ != nullptr && post.kind == PostKind::kTreeCrown) {
    panel.photo = photos_->crown(post.seed);
  }
  fit_texture(panel, 0.0);
  unsorted_.push_back(panel);
}

void PanelBuilder::add_vehicle(const VehicleBody& body, bool lights_on) {
  const Se2 map_from_body = body.map_from_body();
  const std::span<const ProfileCorner> corners = profile_of(body.kind).corners;
  const Eigen::Vector2d left = Se2{0.0, 0.0, body.yaw_rad} * Eigen::Vector2d(0.0, 1.0);
  const auto corner_at = [&](const ProfileCorner& corner, double side) {
    const Eigen::Vector2d place(body.length_m * (corner.x - 0.5), 0.5 * side * body.width_m);
    return from_camera(map_from_body * place, body.height_m * corner.z, body.centre);
  };
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    Panel panel;
    panel.corner = corner_at(corners[i], -1.0);
    const Eigen::Vector3f edge = corner_at(corners[i + 1], -1.0) - panel.corner;
    panel.height_m = edge.norm();
    panel.up = edge / panel.height_m;
    panel.along = {static_cast<float>(left.x()), static_cast<float>(left.y()), 0.0F};
    panel.length_m = static_cast<float>(body.width_m);
    panel.pattern = corners[i].face;
    // The textures of front and windscreen stand upright, so the panel starts at its lower edge.
    if (edge.z() < 0.0F) {
      panel.corner += edge;
      panel.up = -panel.up;
    }
    panel.tint = body.albedo;
    panel.glows = lights_on;
    fit_texture(panel, 0.0);
    unsorted_.push_back(panel);
  }
  add_vehicle_sides(body, map_from_body);
}

void PanelBuilder::add_vehicle_sides(const VehicleBody& body, const Se2& map_from_body) {
  const Eigen::Vector2d forward = Se2{0.0, 0.0, body.yaw_rad} * Eigen::Vector2d(1.0, 0.0);
  for (const double side : {-0.5, 0.5}) {
    Panel panel;
    const Eigen::Vector2d rear(-0.5 * body.length_m, side * body.width_m);
    panel.corner = from_camera(map_from_body * rear, 0.0, body.centre);
    panel.along = {static_cast<float>(forward.x()), static_cast<float>(forward.y()), 0.0F};
    panel.length_m = static_cast<float>(body.length_m);
    panel.height_m = static_cast<float>(body.height_m);
    panel.pattern = profile_of(body.kind).side;
    panel.tint = body.albedo;
    fit_texture(panel, 0.0);
    unsorted_.push_back(panel);
  }
}

}  // namespace bevloc::sim
