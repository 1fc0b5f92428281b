#include "pipeline/calibration/refine/moment_view.h"

#include <Eigen/Geometry>

namespace bevloc {
namespace {

constexpr Duration kAround = std::chrono::milliseconds(20);

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Vector3d on_ground(const Eigen::Vector2d& point) {
  return {point.x(), point.y(), 0.0};
}

/// Returns the derivative of the pixel by the point in the camera frame, from central differences,
/// or nothing if the lens does not see the point.
std::optional<Eigen::Matrix<double, 2, 3>> lens_slope(const Intrinsics& lens,
                                                      const Eigen::Vector3d& point) {
  constexpr double kRelative = 1e-5;
  const double h = kRelative * point.norm();
  Eigen::Matrix<double, 2, 3> slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d by = h * Eigen::Vector3d::Unit(axis);
    const auto more = lens.project(point + by);
    const auto less = lens.project(point - by);
    if (!more || !less) return std::nullopt;
    slope.col(axis) = (*more - *less) / (2.0 * h);
  }
  return slope;
}

}  // namespace

Se3 body_from_vehicle(const FrameVector& frame_error) {
  return {rotation_by(frame_error.head<3>()), frame_error.tail<3>()};
}

std::optional<MomentView> MomentView::make(const CameraModel& camera,
                                           const CameraAdjustment& change,
                                           const FrameVector& frame_error,
                                           const ReferenceTrajectory& reference,
                                           Time picture_time) {
  const Time time = picture_time + from_seconds(change[kTimeOffset]);
  const auto pose = reference.at(time);
  const auto before = reference.at(time - kAround);
  const auto after = reference.at(time + kAround);
  if (!pose || !before || !after) return std::nullopt;
  MomentView view;
  view.camera_ = adjusted(camera, change);
  view.camera_from_body_ = view.camera_.vehicle_from_camera.inverse();
  view.body_from_vehicle_ = body_from_vehicle(frame_error);
  view.vehicle_from_camera_ = (view.camera_from_body_ * view.body_from_vehicle_).inverse();
  view.map_from_vehicle_ = *pose;
  view.vehicle_from_map_ = pose->inverse();
  view.vehicle_from_map_before_ = before->inverse();
  view.vehicle_from_map_after_ = after->inverse();
  return view;
}

Eigen::Vector2d MomentView::eye() const {
  return map_from_vehicle_ * Eigen::Vector2d(vehicle_from_camera_.translation_m.head<2>());
}

std::optional<Eigen::Vector2d> MomentView::project(const Eigen::Vector2d& map_point) const {
  return camera_.intrinsics.project(
      camera_from_body_ * (body_from_vehicle_ * on_ground(vehicle_from_map_ * map_point)));
}

std::optional<PointView> MomentView::look_at(const Eigen::Vector2d& map_point) const {
  const Eigen::Vector3d in_body = body_from_vehicle_ * on_ground(vehicle_from_map_ * map_point);
  const Eigen::Vector3d in_camera = camera_from_body_ * in_body;
  const auto pixel = camera_.intrinsics.project(in_camera);
  const auto slope = lens_slope(camera_.intrinsics, in_camera);
  if (!pixel || !slope) return std::nullopt;
  const Eigen::Vector3d motion_mps = (on_ground(vehicle_from_map_after_ * map_point) -
                                      on_ground(vehicle_from_map_before_ * map_point)) /
                                     (2.0 * to_seconds(kAround));
  const Eigen::Matrix<double, 2, 3> of_body = *slope * camera_from_body_.rotation;
  const Eigen::Matrix<double, 2, 3> of_vehicle = of_body * body_from_vehicle_.rotation;
  PointView view;
  view.pixel = *pixel;
  view.of_camera.leftCols<3>() = *slope * skew(in_camera);
  view.of_camera.middleCols<3>(kForward) = -of_body;
  view.of_camera.col(kFocal) =
      *pixel - Eigen::Vector2d(camera_.intrinsics.cx_px, camera_.intrinsics.cy_px);
  view.of_camera.col(kTimeOffset) = of_vehicle * motion_mps;
  view.of_frame.leftCols<3>() = -of_body * skew(in_body - body_from_vehicle_.translation_m);
  view.of_frame.rightCols<3>() = of_body;
  const Eigen::Matrix2d vehicle_from_map =
      Eigen::Rotation2Dd(-map_from_vehicle_.yaw_rad).toRotationMatrix();
  view.of_point << of_vehicle.leftCols<2>() * vehicle_from_map, of_vehicle.col(2);
  return view;
}

std::optional<Eigen::Vector2d> MomentView::ground_at(const Eigen::Vector2d& pixel) const {
  constexpr double kLeastSlope = 0.02;
  const Eigen::Vector3d ray =
      (vehicle_from_camera_.rotation * camera_.intrinsics.ray(pixel)).normalized();
  if (ray.z() > -kLeastSlope) return std::nullopt;
  const Eigen::Vector3d& eye = vehicle_from_camera_.translation_m;
  const Eigen::Vector3d at = eye - (eye.z() / ray.z()) * ray;
  return map_from_vehicle_ * Eigen::Vector2d(at.head<2>());
}

}  // namespace bevloc
