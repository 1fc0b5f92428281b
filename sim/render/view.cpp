#include "sim/render/view.h"

#include <tuple>

#include <Eigen/Geometry>

namespace bevloc::sim {
namespace {

bool same(const Intrinsics& a, const Intrinsics& b) {
  const auto tie = [](const Intrinsics& k) {
    return std::tie(k.width_px, k.height_px, k.fx_px, k.fy_px, k.cx_px, k.cy_px, k.k1, k.k2, k.p1,
                    k.p2);
  };
  return tie(a) == tie(b);
}

bool is_distorted(const Intrinsics& k) {
  return k.k1 != 0.0 || k.k2 != 0.0 || k.p1 != 0.0 || k.p2 != 0.0;
}

}  // namespace

CameraRays::CameraRays(const Intrinsics& camera)
    : intrinsics(camera), x(static_cast<size_t>(camera.width_px) * camera.height_px), y(x.size()) {
  const bool distorted = is_distorted(camera);
  size_t at = 0;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u, ++at) {
      Eigen::Vector3d ray((u - camera.cx_px) / camera.fx_px, (v - camera.cy_px) / camera.fy_px,
                          1.0);
      if (distorted) ray = camera.ray({u, v});
      x[at] = static_cast<float>(ray.x());
      y[at] = static_cast<float>(ray.y());
    }
  }
  const auto as_row = [](const std::vector<float>& values) {
    return Eigen::Map<const Eigen::ArrayXf>(values.data(),
                                            static_cast<Eigen::Index>(values.size()));
  };
  low = {as_row(x).minCoeff(), as_row(y).minCoeff()};
  high = {as_row(x).maxCoeff(), as_row(y).maxCoeff()};
}

const CameraRays& RayCache::rays_of(const Intrinsics& intrinsics) {
  for (const auto& table : tables_) {
    if (same(table->intrinsics, intrinsics)) return *table;
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
               const BodyMotion& body) {
  const Eigen::Matrix3d heading =
      Eigen::AngleAxisd(map_from_vehicle.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  // About the vehicle's y axis a positive turn lowers the nose, about x it lowers the right side.
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
  return view;
}

}  // namespace bevloc::sim
