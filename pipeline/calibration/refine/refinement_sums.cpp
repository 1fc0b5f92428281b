// The sums of RefinementProblem: sightings and priors, linearized.
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "pipeline/calibration/refine/refinement.h"

namespace bevloc {
namespace {

/// With a residual of this many sigmas, a sighting has a quarter of its weight.
constexpr double kFar = 3.0;
/// The mean over a drive of what differs between framesets, relative to its sigma.
constexpr double kMeanOfSigma = 0.3;
/// One sigma of the body's tilt per acceleration, in radians per m/s^2.
constexpr double kTiltPerAcceleration = 0.01;

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

/// The root of a sighting's weight by Geman and McClure: 1 on the line, nearly 0 far from it.
double nearness_of(double residual) {
  return 1.0 / (1.0 + residual * residual / (kFar * kFar));
}

double cost_of(double residual) {
  return 0.5 * residual * residual * nearness_of(residual);
}

/// d(n . pixel) / d(point in the camera), by central differences. Nothing beyond the lens.
std::optional<Eigen::RowVector3d> lens_slope(const Intrinsics& lens, const Eigen::Vector3d& point,
                                             const Eigen::Vector2d& normal) {
  constexpr double kRelative = 1e-5;
  const double h = kRelative * point.norm();
  Eigen::RowVector3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d by = h * Eigen::Vector3d::Unit(axis);
    const auto more = lens.project(point + by);
    const auto less = lens.project(point - by);
    if (!more || !less) return std::nullopt;
    slope[axis] = normal.dot(*more - *less) / (2.0 * h);
  }
  return slope;
}

}  // namespace

/// Calls visitor(sighting, line or null, distance in pixels) for each sighting of a view. Of
/// several candidates the one nearest to the estimate counts.
void RefinementProblem::visit(const View& view, double gate_rad, const Visitor& visitor) const {
  constexpr Duration kAround = std::chrono::milliseconds(20);
  const CameraAdjustment& change = estimate_.changes[view.camera];
  const CameraModel camera = adjusted(rig_.cameras[view.camera], change);
  const Se3 camera_from_vehicle = camera.vehicle_from_camera.inverse();
  const Time time = view.time + from_seconds(change[kTimeOffset]);
  const auto pose = reference_.at(time);
  const auto before = reference_.at(time - kAround);
  const auto after = reference_.at(time + kAround);
  if (!pose || !before || !after) return;
  const Eigen::Matrix2d vehicle_from_map = Eigen::Rotation2Dd(-pose->yaw_rad).toRotationMatrix();
  const Se3 body = body_from_vehicle(estimate_.frames[static_cast<size_t>(view.frame)].error);
  const auto in_vehicle = [](const Se2& map_from_vehicle, const Eigen::Vector2d& point) {
    const Eigen::Vector2d at = map_from_vehicle.inverse() * point;
    return Eigen::Vector3d(at.x(), at.y(), 0.0);
  };
  for (const PaintSighting& sighting : view.sightings) {
    const Eigen::Vector2d point =
        sighting.point_m + estimate_.shifts[static_cast<size_t>(elements_.at(sighting.element))];
    const Eigen::Vector3d in_body = body * in_vehicle(*pose, point);
    const Eigen::Vector3d in_camera = camera_from_vehicle * in_body;
    const auto pixel = camera.intrinsics.project(in_camera);
    if (!pixel) continue;
    const double predicted_px = sighting.normal_px.dot(*pixel - sighting.predicted_px);
    double nearest_px = std::numeric_limits<double>::infinity();
    for (int i = 0; i < sighting.candidates; ++i) {
      const double distance_px = predicted_px - sighting.offset_px[static_cast<size_t>(i)];
      if (std::abs(distance_px) < std::abs(nearest_px)) nearest_px = distance_px;
    }
    const auto slope = lens_slope(camera.intrinsics, in_camera, sighting.normal_px);
    if (!slope || !(std::abs(nearest_px) <= gate_rad * camera.intrinsics.fx_px)) {
      visitor(sighting, nullptr, nearest_px);
      continue;
    }
    const double per_sigma =
        1.0 /
        (sigma_scale_ * std::hypot(options_.image_px, options_.paint_m * sighting.pixels_per_m));
    const Eigen::RowVector3d of_vehicle = *slope * camera_from_vehicle.rotation;
    const Eigen::Vector3d motion =
        (in_vehicle(*after, point) - in_vehicle(*before, point)) / (2.0 * to_seconds(kAround));
    Line line;
    line.residual = nearest_px * per_sigma;
    line.weight = nearness_of(line.residual) * nearness_of(line.residual);
    line.of_camera.head<3>() = (*slope * skew(in_camera)).transpose();
    line.of_camera.segment<3>(kForward) = -of_vehicle.transpose();
    line.of_camera[kFocal] = sighting.normal_px.dot(
        *pixel - Eigen::Vector2d(camera.intrinsics.cx_px, camera.intrinsics.cy_px));
    line.of_camera[kTimeOffset] = of_vehicle.dot(body.rotation * motion);
    line.of_frame.head<3>() = (-of_vehicle * skew(in_body - body.translation_m)).transpose();
    line.of_frame.tail<3>() = of_vehicle.transpose();
    const Eigen::RowVector3d of_ground = of_vehicle * body.rotation;
    line.of_element = per_sigma * (of_ground.head<2>() * vehicle_from_map).transpose();
    line.of_camera *= per_sigma;
    line.of_frame *= per_sigma;
    for (int i = 0; i < kCameraParameters; ++i) {
      if (!free_[view.camera][static_cast<size_t>(i)]) line.of_camera[i] = 0.0;
    }
    visitor(sighting, &line, nearest_px);
  }
}

void RefinementProblem::add_frame_priors(Sums& sums) const {
  const FrameVector weight = frame_sigma().cwiseAbs2().cwiseInverse();
  for (size_t k = 0; k < estimate_.frames.size(); ++k) {
    const Frame& frame = estimate_.frames[k];
    const FrameVector off = frame.error - expected_error(frame);
    // The expected error depends on the mean and on the tilt per acceleration.
    Eigen::Matrix<double, kFrameUnknowns, kFrameUnknowns + kTiltsPerAcceleration> slope;
    slope << FrameMatrix::Identity(), Eigen::Matrix<double, kFrameUnknowns, 2>::Zero();
    slope(0, kFrameUnknowns) = frame.acceleration_mps2.y();
    slope(1, kFrameUnknowns + 1) = frame.acceleration_mps2.x();
    FrameSums& of = sums.frames[k];
    of.information += weight.asDiagonal();
    of.gradient += weight.cwiseProduct(off);
    const auto weighted = (slope.transpose() * weight.asDiagonal()).eval();
    of.shared.middleRows<slope.ColsAtCompileTime>(kCameraUnknowns) -= weighted;
    sums.gradient.segment<slope.ColsAtCompileTime>(kCameraUnknowns) -= weighted * off;
    sums.information.block<slope.ColsAtCompileTime, slope.ColsAtCompileTime>(
        kCameraUnknowns, kCameraUnknowns) += weighted * slope;
    sums.cost += 0.5 * off.dot(weight.cwiseProduct(off));
  }
  Eigen::VectorXd values(sums.gradient.size() - kCameraUnknowns);
  Eigen::VectorXd weights(values.size());
  values.head<kFrameUnknowns>() = estimate_.mean;
  weights.head<kFrameUnknowns>() = weight / (kMeanOfSigma * kMeanOfSigma);
  values.segment<kTiltsPerAcceleration>(kFrameUnknowns) = estimate_.tilt_per_acceleration;
  weights.segment<kTiltsPerAcceleration>(kFrameUnknowns)
      .setConstant(1.0 / (kTiltPerAcceleration * kTiltPerAcceleration));
  for (size_t i = 0; i < estimate_.shifts.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(kFirstElement - kCameraUnknowns + 2 * i);
    values.segment<2>(first) = estimate_.shifts[i];
    weights.segment<2>(first).setConstant(1.0 / (options_.map_m * options_.map_m));
  }
  sums.gradient.tail(values.size()) += weights.cwiseProduct(values);
  sums.information.diagonal().tail(values.size()) += weights;
  sums.cost += 0.5 * values.dot(weights.cwiseProduct(values));
}

void RefinementProblem::add_line(const View& view, const PaintSighting& sighting, const Line& line,
                                 Sums& sums) const {
  FrameSums& frame = sums.frames[static_cast<size_t>(view.frame)];
  const Eigen::Index camera = view.camera * kCameraParameters;
  const Eigen::Index element = kFirstElement + 2 * elements_.at(sighting.element);
  const CameraAdjustment of_camera = line.weight * line.of_camera;
  const Eigen::Vector2d of_element = line.weight * line.of_element;
  Eigen::MatrixXd& all = sums.information;
  all.block<kCameraParameters, kCameraParameters>(camera, camera) +=
      of_camera * line.of_camera.transpose();
  all.block<kCameraParameters, 2>(camera, element) += of_camera * line.of_element.transpose();
  all.block<2, kCameraParameters>(element, camera) += of_element * line.of_camera.transpose();
  all.block<2, 2>(element, element) += of_element * line.of_element.transpose();
  sums.gradient.segment<kCameraParameters>(camera) += line.residual * of_camera;
  sums.gradient.segment<2>(element) += line.residual * of_element;
  frame.shared.middleRows<kCameraParameters>(camera) += of_camera * line.of_frame.transpose();
  frame.shared.middleRows<2>(element) += of_element * line.of_frame.transpose();
  frame.information += line.weight * line.of_frame * line.of_frame.transpose();
  frame.gradient += line.weight * line.residual * line.of_frame;
}

RefinementProblem::Sums RefinementProblem::linearize(double gate_rad) const {
  const auto unknowns = static_cast<Eigen::Index>(kFirstElement + 2 * estimate_.shifts.size());
  Sums sums;
  sums.information = Eigen::MatrixXd::Zero(unknowns, unknowns);
  sums.gradient = Eigen::VectorXd::Zero(unknowns);
  sums.frames.resize(estimate_.frames.size());
  for (FrameSums& frame : sums.frames) {
    frame.shared = Eigen::MatrixXd::Zero(unknowns, kFrameUnknowns);
  }
  add_frame_priors(sums);
  for (const View& view : views_) {
    if (free_[view.camera].none()) continue;
    visit(view, gate_rad, [&](const PaintSighting& sighting, const Line* line, double) {
      // A sighting without paint near the estimate costs as much as paint that is far off.
      sums.cost += line ? cost_of(line->residual) : 0.5 * kFar * kFar;
      if (line) add_line(view, sighting, *line, sums);
    });
  }
  return sums;
}

/// The information with the framesets' unknowns eliminated.
Eigen::MatrixXd RefinementProblem::reduced(const Sums& sums) const {
  Eigen::MatrixXd result = sums.information;
  for (const FrameSums& frame : sums.frames) {
    result -= frame.shared * frame.information.llt().solve(frame.shared.transpose());
  }
  return 0.5 * (result + result.transpose());
}

/// The information about the cameras, with everything else eliminated, without their priors.
Eigen::MatrixXd RefinementProblem::camera_information(double gate_rad) const {
  const Eigen::MatrixXd all = reduced(linearize(gate_rad));
  const Eigen::Index rest = all.rows() - kCameraUnknowns;
  const Eigen::MatrixXd joint = all.topRightCorner(kCameraUnknowns, rest);
  const Eigen::MatrixXd result =
      all.topLeftCorner(kCameraUnknowns, kCameraUnknowns) -
      joint * all.bottomRightCorner(rest, rest).llt().solve(joint.transpose());
  return 0.5 * (result + result.transpose());
}

}  // namespace bevloc
