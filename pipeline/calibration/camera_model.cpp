#include "pipeline/calibration/camera_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "common/plane.h"

namespace bevloc {
namespace {

/// Squared normalised radius up to which the distorted radius r (1 + k1 r^2 + k2 r^4) increases:
/// the smallest positive root of its derivative 1 + 3 k1 s + 5 k2 s^2 in s = r^2.
double monotonic_radius_squared(double k1, double k2) {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  const double discriminant = 9.0 * k1 * k1 - 20.0 * k2;
  if (discriminant < 0.0 || (k1 >= 0.0 && k2 >= 0.0)) return kUnbounded;
  // This form of the root, -2 / (b - sqrt(b^2 - 4ac)), is numerically stable and holds for k2 = 0.
  const double root = -2.0 / (3.0 * k1 - std::sqrt(discriminant));
  return root > 0.0 ? root : kUnbounded;
}

struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d jacobian;
};

/// OpenCV's radial-tangential distortion and its derivative.
Distorted distort(const Intrinsics& camera, const Eigen::Vector2d& normalised) {
  const double x = normalised.x();
  const double y = normalised.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (camera.k1 + r2 * camera.k2);
  const double radial_slope = camera.k1 + 2.0 * camera.k2 * r2;
  const double p1 = camera.p1;
  const double p2 = camera.p2;
  Distorted result;
  result.point = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                  y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  const double mixed = 2.0 * x * y * radial_slope + 2.0 * p1 * x + 2.0 * p2 * y;
  result.jacobian << radial + 2.0 * x * x * radial_slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed,
      mixed, radial + 2.0 * y * y * radial_slope + 6.0 * p1 * y + 2.0 * p2 * x;
  return result;
}

/// The distorted angle of a fisheye, and its derivative.
struct DistortedAngle {
  double value;
  double slope;
};

DistortedAngle distort_angle(const Intrinsics& camera, double angle) {
  const double s = angle * angle;
  const auto& [k1, k2, k3, k4] = std::tie(camera.k1, camera.k2, camera.k3, camera.k4);
  return {angle * (1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4)))),
          1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * (7.0 * k3 + s * 9.0 * k4)))};
}

std::optional<Eigen::Vector2d> project_fisheye(const Intrinsics& camera,
                                               const Eigen::Vector3d& point_camera) {
  const double radius = point_camera.head<2>().norm();
  const double angle = std::atan2(radius, point_camera.z());
  const DistortedAngle distorted = distort_angle(camera, angle);
  if (!(angle <= Intrinsics::kWidestFisheye_rad && distorted.slope > 0.0)) return std::nullopt;
  const double scale = radius > 0.0 ? distorted.value / radius : 0.0;
  return Eigen::Vector2d(camera.fx_px * scale * point_camera.x() + camera.cx_px,
                         camera.fy_px * scale * point_camera.y() + camera.cy_px);
}

/// The direction of `target`, whose length is the distorted angle, at z = 1.
Eigen::Vector3d fisheye_ray(const Intrinsics& camera, const Eigen::Vector2d& target) {
  constexpr int kMaxSteps = 30;
  constexpr double kConverged = 1e-13;
  const double wanted = target.norm();
  if (wanted == 0.0) return Eigen::Vector3d::UnitZ();
  double low = 0.0;
  double high = Intrinsics::kWidestFisheye_rad;
  double angle = std::min(wanted, high);
  for (int step = 0; step < kMaxSteps; ++step) {
    const DistortedAngle distorted = distort_angle(camera, angle);
    const bool rises = distorted.slope > 0.0;
    (rises && distorted.value <= wanted ? low : high) = angle;
    // Newton's method, and bisection where the distorted angle falls again.
    double next = angle + (wanted - distorted.value) / distorted.slope;
    const bool leaves = next >= high && high < Intrinsics::kWidestFisheye_rad;
    next = !rises || leaves ? 0.5 * (low + high)
                            : std::clamp(next, low, Intrinsics::kWidestFisheye_rad);
    const bool converged = std::abs(next - angle) < kConverged;
    angle = next;
    if (converged) break;
  }
  const Eigen::Vector2d beside = std::tan(angle) / wanted * target;
  return {beside.x(), beside.y(), 1.0};
}

}  // namespace

Eigen::Matrix3d rotation_by(const Eigen::Vector3d& vector) {
  const double angle_rad = vector.norm();
  if (angle_rad == 0.0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle_rad, vector / angle_rad).toRotationMatrix();
}

std::optional<Eigen::Vector2d> Intrinsics::project(const Eigen::Vector3d& point_camera) const {
  if (!(point_camera.z() > 0.0)) return std::nullopt;
  if (lens == Lens::kFisheye) return project_fisheye(*this, point_camera);
  const Eigen::Vector2d normalised = point_camera.head<2>() / point_camera.z();
  if (!(normalised.squaredNorm() < monotonic_radius_squared(k1, k2))) return std::nullopt;
  const Eigen::Vector2d distorted = distort(*this, normalised).point;
  return Eigen::Vector2d(fx_px * distorted.x() + cx_px, fy_px * distorted.y() + cy_px);
}

Eigen::Vector3d Intrinsics::ray(const Eigen::Vector2d& pixel) const {
  constexpr int kMaxSteps = 30;
  constexpr double kConverged = 1e-13;
  const Eigen::Vector2d target((pixel.x() - cx_px) / fx_px, (pixel.y() - cy_px) / fy_px);
  if (lens == Lens::kFisheye) return fisheye_ray(*this, target);
  const double limit_squared = monotonic_radius_squared(k1, k2);
  // Newton's method, limited to the radius where the distortion is monotonic.
  const auto within_limit = [limit_squared](const Eigen::Vector2d& point) -> Eigen::Vector2d {
    const double r2 = point.squaredNorm();
    return r2 < limit_squared ? point : 0.999 * std::sqrt(limit_squared / r2) * point;
  };
  Eigen::Vector2d normalised = within_limit(target);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Distorted distorted = distort(*this, normalised);
    const Eigen::Vector2d change = distorted.jacobian.inverse() * (target - distorted.point);
    normalised = within_limit(normalised + change);
    if (change.lpNorm<Eigen::Infinity>() < kConverged) break;
  }
  return {normalised.x(), normalised.y(), 1.0};
}

Intrinsics resized(const Intrinsics& lens, int width_px, int height_px) {
  // One scale for both axes: a height that is not divisible is rounded, but the pixels stay square.
  const double scale = static_cast<double>(width_px) / lens.width_px;
  Intrinsics result = lens;
  result.width_px = width_px;
  result.height_px = height_px;
  result.fx_px *= scale;
  result.fy_px *= scale;
  // Pixel centres are integers, so u + 0.5 scales.
  result.cx_px = (lens.cx_px + 0.5) * scale - 0.5;
  result.cy_px = (lens.cy_px + 0.5) * scale - 0.5;
  return result;
}

bool CameraModel::shows_own_body(const Eigen::Vector2d& pixel) const {
  return is_in_ring(pixel, own_body_px);
}

CameraModel resized(const CameraModel& camera, int width_px, int height_px) {
  const double scale = static_cast<double>(width_px) / camera.intrinsics.width_px;
  CameraModel result = camera;
  result.intrinsics = resized(camera.intrinsics, width_px, height_px);
  for (Eigen::Vector2d& corner : result.own_body_px) {
    corner = (corner.array() + 0.5) * scale - 0.5;
  }
  return result;
}

}  // namespace bevloc
