#include "sim/render/view.h"

#include <limits>

#include <Eigen/Geometry>

#include "common/target_clones.h"

namespace bevloc::sim {
namespace {

constexpr float kMostSteps = 65535.0F;

/// Calls take(ray) for all pixels, row by row.
template <typename Take>
void for_each_ray(const Intrinsics& camera, Take take) {
  const bool distorted = !camera.is_straight();
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      Eigen::Vector2d ray((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px);
      if (distorted) ray = camera.ray({u, v}).head<2>();
      take(Eigen::Vector2f(ray.cast<float>()));
    }
  }
}

BEVLOC_TARGET_CLONES
void unpack(const uint16_t* steps, float low, float step, int count, float* values) {
  for (int i = 0; i < count; ++i) values[i] = low + step * static_cast<float>(steps[i]);
}

}  // namespace

CameraRays::CameraRays(const Intrinsics& camera) : intrinsics_(camera) {
  // Computes all rays twice to avoid a float copy of them.
  Eigen::AlignedBox2f box;
  for_each_ray(camera, [&](const Eigen::Vector2f& ray) { box.extend(ray); });
  low_ = box.min();
  high_ = box.max();
  step_ = (box.sizes() / kMostSteps).cwiseMax(std::numeric_limits<float>::min());
  const size_t pixels = static_cast<size_t>(camera.width_px) * camera.height_px;
  x_.reserve(pixels);
  y_.reserve(pixels);
  for_each_ray(camera, [&](const Eigen::Vector2f& ray) {
    const Eigen::Array2f steps = ((ray - low_).array() / step_.array() + 0.5F).min(kMostSteps);
    x_.push_back(static_cast<uint16_t>(steps.x()));
    y_.push_back(static_cast<uint16_t>(steps.y()));
  });
}

void CameraRays::get(size_t start, int count, float* x, float* y) const {
  unpack(&x_[start], low_.x(), step_.x(), count, x);
  unpack(&y_[start], low_.y(), step_.y(), count, y);
}

const CameraRays& RayCache::rays_of(const Intrinsics& intrinsics) {
  for (const auto& table : tables_) {
    if (table->intrinsics() == intrinsics) return *table;
  }
  auto made = std::make_unique<CameraRays>(intrinsics);
  if (tables_.size() < kCapacity) {
    tables_.push_back(std::move(made));
    return *tables_.back();
  }
  const size_t slot = oldest_;
  oldest_ = (oldest_ + 1) % kCapacity;
  tables_[slot] = std::move(made);
  return *tables_[slot];
}

View make_view(const CameraRays& rays, const Se3& vehicle_from_camera, const Se2& map_from_vehicle,
               const Stance& stance) {
  const BodyMotion& body = stance.body;
  const Eigen::Matrix3d heading =
      Eigen::AngleAxisd(map_from_vehicle.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  // A positive rotation about the vehicle's y axis lowers the nose; about x, the right side.
  const Eigen::Matrix3d tilt = (Eigen::AngleAxisd(body.pitch_rad, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(body.roll_rad, Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  const Se3 map_from_body{heading * tilt,
                          {map_from_vehicle.x_m, map_from_vehicle.y_m, body.lift_m}};
  const Se3 map_from_camera = map_from_body * vehicle_from_camera;
  View view;
  view.rays = &rays;
  view.position = map_from_camera.translation_m;
  view.map_from_camera = map_from_camera.rotation.cast<float>();
  view.vehicle = map_from_vehicle.translation();
  view.vehicle_forward = heading.col(0).head<2>().cast<float>();
  view.ground = CurvedGround(stance.ground, map_from_vehicle);
  return view;
}

}  // namespace bevloc::sim
