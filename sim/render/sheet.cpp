#include "sim/render/sheet.h"

#include <algorithm>
#include <cmath>

#include "sim/random.h"
#include "sim/render/vehicle_profile.h"

namespace bevloc::sim {
namespace {

constexpr float kStoreyM = 3.2F;

/// Spreads the sheet's picture over it, as its texture wants.
void fit_picture(Sheet& sheet, double start_m) {
  const Texture& texture = texture_of(sheet.pattern);
  const bool repeats_u = texture.period_u_m > 0.0F;
  sheet.u_per_m = 1.0F / (repeats_u ? texture.period_u_m : sheet.length_m);
  sheet.v_per_m = 1.0F / (texture.period_v_m > 0.0F ? texture.period_v_m : sheet.height_m);
  if (sheet.pattern == Pattern::kFacade) {
    // Whole storeys: no roof cuts through a window.
    const float storeys = std::max(1.0F, std::round(sheet.height_m / kStoreyM));
    sheet.v_per_m = storeys / (static_cast<float>(kFacadeStoreys) * sheet.height_m);
  }
  sheet.u_start =
      repeats_u ? static_cast<float>(std::fmod(start_m, texture.period_u_m)) * sheet.u_per_m : 0.0F;
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

const std::vector<Sheet>& SheetBuilder::build(const Eigen::Vector3d& camera,
                                              const Surroundings& surroundings) {
  camera_ = camera;
  unsorted_.clear();
  for (const WallPiece* piece : surroundings.walls) add_wall(*piece);
  for (const Post* post : surroundings.posts) add_post(*post);
  for (const VehicleBody& body : surroundings.parked) add_vehicle(body, false);
  for (const VehicleBody& body : surroundings.traffic) add_vehicle(body, true);
  order_.clear();
  for (size_t i = 0; i < unsorted_.size(); ++i) {
    const Sheet& s = unsorted_[i];
    const Eigen::Vector3f middle = s.corner + 0.5F * (s.length_m * s.along + s.height_m * s.up);
    order_.emplace_back(-middle.squaredNorm(), static_cast<int>(i));
  }
  std::sort(order_.begin(), order_.end());
  sheets_.clear();
  for (const auto& [distance, item] : order_) {
    sheets_.push_back(unsorted_[static_cast<size_t>(item)]);
  }
  return sheets_;
}

void SheetBuilder::add_wall(const WallPiece& piece) {
  const Wall& wall = *piece.wall;
  const Eigen::Vector2d way = piece.to - piece.from;
  Sheet sheet;
  sheet.corner = from_camera(piece.from, wall.bottom_m);
  sheet.length_m = static_cast<float>(way.norm());
  sheet.height_m = static_cast<float>(wall.top_m - wall.bottom_m);
  if (sheet.height_m <= 0.0F) return;
  const Eigen::Vector2f direction = way.normalized().cast<float>();
  sheet.along = {direction.x(), direction.y(), 0.0F};
  sheet.pattern = pattern_of(wall.texture);
  sheet.tint = wall.albedo;
  sheet.softness = wall.texture == WallTexture::kHedge ? 0.7F : 0.0F;
  sheet.glows = wall.texture == WallTexture::kFacade;
  // The seed shifts the picture, so that walls of a kind are not all alike.
  const double shift_m = static_cast<double>(mix_seed(wall.seed) % 4096U) * 0.05;
  fit_picture(sheet, piece.start_m + shift_m);
  unsorted_.push_back(sheet);
}

void SheetBuilder::add_post(const Post& post) {
  const Eigen::Vector2d to_post = post.position - camera_.head<2>();
  const double distance_m = to_post.norm();
  if (distance_m < post.radius_m + 0.2 || post.top_m <= post.bottom_m) return;
  const Eigen::Vector2d across(to_post.y() / distance_m, -to_post.x() / distance_m);
  Sheet sheet;
  sheet.corner = from_camera(post.position - post.radius_m * across, post.bottom_m);
  sheet.along = {static_cast<float>(across.x()), static_cast<float>(across.y()), 0.0F};
  sheet.length_m = static_cast<float>(2.0 * post.radius_m);
  sheet.height_m = static_cast<float>(post.top_m - post.bottom_m);
  sheet.pattern = pattern_of(post.kind);
  sheet.tint = post.albedo;
  sheet.softness = post.kind == PostKind::kTreeCrown ? 0.8F : 0.4F;
  fit_picture(sheet, 0.0);
  unsorted_.push_back(sheet);
}

void SheetBuilder::add_vehicle(const VehicleBody& body, bool lights_on) {
  const Se2 map_from_body{body.centre.x(), body.centre.y(), body.yaw_rad};
  const std::span<const ProfileCorner> corners = profile_of(body.kind).corners;
  const Eigen::Vector2d left = Se2{0.0, 0.0, body.yaw_rad} * Eigen::Vector2d(0.0, 1.0);
  const auto corner_at = [&](const ProfileCorner& corner, double side) {
    const Eigen::Vector2d place(body.length_m * (corner.x - 0.5), 0.5 * side * body.width_m);
    return from_camera(map_from_body * place, body.height_m * corner.z);
  };
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    Sheet sheet;
    sheet.corner = corner_at(corners[i], -1.0);
    const Eigen::Vector3f way = corner_at(corners[i + 1], -1.0) - sheet.corner;
    sheet.height_m = way.norm();
    sheet.up = way / sheet.height_m;
    sheet.along = {static_cast<float>(left.x()), static_cast<float>(left.y()), 0.0F};
    sheet.length_m = static_cast<float>(body.width_m);
    sheet.pattern = corners[i].face;
    // The front's and the glass's pictures stand upright: from the lower edge to the upper.
    if (way.z() < 0.0F) {
      sheet.corner += way;
      sheet.up = -sheet.up;
    }
    sheet.tint = body.albedo;
    sheet.glows = lights_on;
    fit_picture(sheet, 0.0);
    unsorted_.push_back(sheet);
  }
  add_vehicle_sides(body, map_from_body);
}

void SheetBuilder::add_vehicle_sides(const VehicleBody& body, const Se2& map_from_body) {
  const Eigen::Vector2d forward = Se2{0.0, 0.0, body.yaw_rad} * Eigen::Vector2d(1.0, 0.0);
  for (const double side : {-0.5, 0.5}) {
    Sheet sheet;
    const Eigen::Vector2d rear(-0.5 * body.length_m, side * body.width_m);
    sheet.corner = from_camera(map_from_body * rear, 0.0);
    sheet.along = {static_cast<float>(forward.x()), static_cast<float>(forward.y()), 0.0F};
    sheet.length_m = static_cast<float>(body.length_m);
    sheet.height_m = static_cast<float>(body.height_m);
    sheet.pattern = profile_of(body.kind).side;
    sheet.tint = body.albedo;
    fit_picture(sheet, 0.0);
    unsorted_.push_back(sheet);
  }
}

}  // namespace bevloc::sim
