// The rows of RefinementProblem: sightings, ties and priors, linearized.
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "pipeline/calibration/refine/refinement.h"

namespace bevloc {
namespace {

/// With a residual of this many sigmas, a sighting has a quarter of its weight.
constexpr double kFar = 3.0;
/// The unknowns of a frameset have a mean over the drive. The sigma of this mean is this share of
/// their sigma in one frameset.
constexpr double kMeanOfSigma = 0.3;
/// One sigma of the body's tilt per acceleration, in radians per m/s^2.
constexpr double kTiltPerAcceleration = 0.01;
/// The errors of the reference poses are correlated over this time.
constexpr double kReferenceDrift_s = 10.0;
// One sigma of where paint is found: in the image, and on the ground against its line.
constexpr double kPaintSigma_px = 0.4;
constexpr double kPaintSigma_m = 0.01;
// One sigma of tie points: of their pixels, of the height of the ground, and along the ground. That
// of the height counts twice: for the mean height of the ground that a camera sees, and for the
// height of each point against this mean.
constexpr double kTieSigma_px = 0.4;
constexpr double kTieHeightSigma_m = 0.08;
constexpr double kTieSigma_m = 0.01;

/// The root of a sighting's weight by Geman and McClure: 1 on the line, nearly 0 far from it.
double nearness_of(double residual) {
  return 1.0 / (1.0 + residual * residual / (kFar * kFar));
}

double weight_of(double residual) {
  return nearness_of(residual) * nearness_of(residual);
}

double cost_of(double residual) {
  return 0.5 * residual * residual * nearness_of(residual);
}

/// A sighting without paint near the estimate costs as much as paint that is far off.
constexpr double kCostOfNothing = 0.5 * kFar * kFar;

void add_prior(const RefinementRow& row, RefinementSums& sums) {
  sums.cost += 0.5 * row.residual * row.residual;
  sums.add(row);
}

/// The place on the ground that a pixel shows, in the map frame, and its derivatives.
struct GroundPoint {
  Eigen::Vector2d at;
  Eigen::Matrix2d of_pixel;
  Eigen::Matrix<double, 2, kCameraParameters> of_camera;
  Eigen::Matrix<double, 2, kFrameUnknowns> of_frame;
  Eigen::Vector2d of_height;
};

std::optional<GroundPoint> ground_point(const MomentView& view, const Eigen::Vector2d& pixel) {
  const auto at = view.ground_at(pixel);
  if (!at) return std::nullopt;
  const auto point = view.look_at(*at);
  if (!point) return std::nullopt;
  GroundPoint result;
  result.at = *at;
  result.of_pixel = point->of_point.leftCols<2>().inverse();
  result.of_camera = -result.of_pixel * point->of_camera;
  result.of_frame = -result.of_pixel * point->of_frame;
  result.of_height = -result.of_pixel * point->of_point.col(2);
  return result;
}

}  // namespace

std::optional<MomentView> RefinementProblem::view_of(const Picture& picture,
                                                     const FrameVector& frame_error) const {
  return MomentView::make(rig_.cameras[picture.camera], estimate_.changes[picture.camera],
                          frame_error, reference_, picture.time);
}

/// If there are several candidates, the one nearest to the estimate counts.
void RefinementProblem::visit(const View& view, double gate_rad, const Visitor& visitor) const {
  const auto moment =
      view_of(view.picture, estimate_.frames[static_cast<size_t>(view.picture.frame)].error);
  if (!moment) return;
  const double gate_px = gate_rad * moment->camera().intrinsics.fx_px;
  for (const PaintSighting& sighting : view.sightings) {
    const Eigen::Vector2d at =
        sighting.point_m + estimate_.shifts[static_cast<size_t>(elements_.at(sighting.element))];
    const auto pixel = moment->project(at);
    if (!pixel) continue;
    const double predicted_px = sighting.normal_px.dot(*pixel - sighting.predicted_px);
    double nearest_px = std::numeric_limits<double>::infinity();
    for (int i = 0; i < sighting.candidates; ++i) {
      const double distance_px = predicted_px - sighting.offset_px[static_cast<size_t>(i)];
      if (std::abs(distance_px) < std::abs(nearest_px)) nearest_px = distance_px;
    }
    const bool is_near = std::abs(nearest_px) <= gate_px;
    const auto point = is_near ? moment->look_at(at) : std::nullopt;
    if (!point) {
      visitor(sighting, nullptr, nearest_px);
      continue;
    }
    const double per_px =
        1.0 / (sigma_scale_ * std::hypot(kPaintSigma_px, kPaintSigma_m * sighting.pixels_per_m));
    const Line line{nearest_px * per_px, per_px, *point};
    visitor(sighting, &line, nearest_px);
  }
}

void RefinementProblem::visit(const Ties& ties, double gate_rad, const TieVisitor& visitor) const {
  const auto first =
      view_of(ties.first, estimate_.frames[static_cast<size_t>(ties.first.frame)].error);
  const auto second =
      view_of(ties.second, estimate_.frames[static_cast<size_t>(ties.second.frame)].error);
  if (!first || !second) return;
  for (const GroundTie& tie : ties.ties) {
    const auto rows = linearize(tie, ties, *first, *second, gate_rad);
    visitor(rows ? &*rows : nullptr);
  }
}

std::optional<RefinementProblem::TieRows> RefinementProblem::linearize(
    const GroundTie& tie, const Ties& ties, const MomentView& first_view,
    const MomentView& second_view, double gate_rad) const {
  const auto first = ground_point(first_view, tie.first_px);
  const auto second = ground_point(second_view, tie.second_px);
  if (!first || !second) return std::nullopt;
  const double first_height_m = estimate_.heights_m[ties.first.camera];
  const double second_height_m = estimate_.heights_m[ties.second.camera];
  const Eigen::Vector2d apart = first->at + first_height_m * first->of_height - second->at -
                                second_height_m * second->of_height;
  const Eigen::Vector2d apart_px = second->of_pixel.inverse() * apart;
  if (!(apart_px.norm() <= gate_rad * second_view.camera().intrinsics.fx_px)) return std::nullopt;
  const double px = sigma_scale_ * kTieSigma_px;
  const double floor_m = sigma_scale_ * kTieSigma_m;
  const Eigen::Vector2d of_height = kTieHeightSigma_m * (first->of_height - second->of_height);
  const Eigen::Matrix2d covariance = px * px *
                                         (first->of_pixel * first->of_pixel.transpose() +
                                          second->of_pixel * second->of_pixel.transpose()) +
                                     of_height * of_height.transpose() +
                                     floor_m * floor_m * Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d whiten = covariance.llt().matrixL().solve(Eigen::Matrix2d::Identity());
  const Eigen::Vector2d residual = whiten * apart;
  const double weight = weight_of(residual.norm());
  TieRows result{residual.norm(), {{{residual[0], weight}, {residual[1], weight}}}};
  const Eigen::Matrix<double, 2, kCameraParameters> of_first = whiten * first->of_camera;
  const Eigen::Matrix<double, 2, kCameraParameters> of_second = -whiten * second->of_camera;
  const Eigen::Matrix<double, 2, kFrameUnknowns> of_first_frame = whiten * first->of_frame;
  const Eigen::Matrix<double, 2, kFrameUnknowns> of_second_frame = -whiten * second->of_frame;
  for (int axis = 0; axis < 2; ++axis) {
    RefinementRow& row = result.rows[static_cast<size_t>(axis)];
    row.add_shared(ties.first.camera * kCameraParameters,
                   only_free(ties.first.camera, of_first.row(axis).transpose()));
    row.add_shared(ties.second.camera * kCameraParameters,
                   only_free(ties.second.camera, of_second.row(axis).transpose()));
    row.add_shared(kFirstHeight + ties.first.camera,
                   Eigen::Matrix<double, 1, 1>(whiten.row(axis).dot(first->of_height)));
    row.add_shared(kFirstHeight + ties.second.camera,
                   Eigen::Matrix<double, 1, 1>(-whiten.row(axis).dot(second->of_height)));
    row.add_frame(ties.first.frame, of_first_frame.row(axis).transpose());
    row.add_frame(ties.second.frame, of_second_frame.row(axis).transpose());
  }
  return result;
}

CameraAdjustment RefinementProblem::only_free(int camera, CameraAdjustment slope) const {
  for (int i = 0; i < kCameraParameters; ++i) {
    if (!free_[camera][static_cast<size_t>(i)]) slope[i] = 0.0;
  }
  return slope;
}

/// Adds the prior of a frameset's error. Its mean is the error that the mean of the drive and the
/// acceleration predict. The errors of the reference pose (yaw, forward, left) drift, so their
/// prior also depends on the errors of the frameset before.
void RefinementProblem::add_frame_prior(size_t k, RefinementSums& sums) const {
  const Frame& frame = estimate_.frames[k];
  FrameVector sigma = frame_sigma();
  FrameVector off = frame.error - expected_error(frame);
  FrameMatrix kept = FrameMatrix::Zero();  // share kept from the frameset before
  if (k > 0) {
    const Frame& before = estimate_.frames[k - 1];
    const double share = std::exp(-to_seconds(frame.time - before.time) / kReferenceDrift_s);
    kept(kYawError, kYawError) = share;
    kept.block<2, 2>(kForwardError, kForwardError) =
        share * Eigen::Rotation2Dd(before.reference_yaw_rad - frame.reference_yaw_rad).matrix();
    sigma.segment<3>(kYawError) *= std::sqrt(1.0 - share * share);
    off -= kept * (before.error - expected_error(before));
  }
  for (int i = 0; i < kFrameUnknowns; ++i) {
    RefinementRow row(off[i] / sigma[i], 1.0);
    const FrameVector of_before = -kept.row(i).transpose() / sigma[i];
    const FrameVector of_frame = FrameVector::Unit(i) / sigma[i];
    row.add_frame(static_cast<int>(k), of_frame);
    if (k > 0) row.add_frame(static_cast<int>(k) - 1, of_before);
    row.add_shared(kCameraUnknowns, (-of_frame - of_before).eval());
    if (i < kTiltsPerAcceleration) {
      row.add_shared(kCameraUnknowns + kFrameUnknowns + i,
                     Eigen::Matrix<double, 1, 1>(-frame.acceleration_mps2[1 - i] / sigma[i]));
    }
    add_prior(row, sums);
  }
}

void RefinementProblem::add_priors(RefinementSums& sums) const {
  const FrameVector sigma = frame_sigma();
  const auto add_shared = [&](Eigen::Index unknown, double value, double of_sigma) {
    RefinementRow row(value / of_sigma, 1.0);
    row.add_shared(unknown, Eigen::Matrix<double, 1, 1>(1.0 / of_sigma));
    add_prior(row, sums);
  };
  for (size_t k = 0; k < estimate_.frames.size(); ++k) add_frame_prior(k, sums);
  for (int i = 0; i < kFrameUnknowns; ++i) {
    add_shared(kCameraUnknowns + i, estimate_.mean[i], kMeanOfSigma * sigma[i]);
  }
  for (int i = 0; i < kTiltsPerAcceleration; ++i) {
    add_shared(kCameraUnknowns + kFrameUnknowns + i, estimate_.tilt_per_acceleration[i],
               kTiltPerAcceleration);
  }
  for (int c = 0; c < kCameraCount; ++c) {
    add_shared(kFirstHeight + c, estimate_.heights_m[c], kTieHeightSigma_m);
  }
  for (size_t i = 0; i < estimate_.shifts.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      add_shared(kFirstElement + static_cast<Eigen::Index>(2 * i) + axis, estimate_.shifts[i][axis],
                 options_.map_m);
    }
  }
}

RefinementSums RefinementProblem::linearize(double gate_rad) const {
  const auto unknowns = static_cast<Eigen::Index>(kFirstElement + 2 * estimate_.shifts.size());
  RefinementSums sums(unknowns, estimate_.frames.size());
  add_priors(sums);
  for (const View& view : views_) {
    const int camera = view.picture.camera;
    if (free_[camera].none()) continue;
    visit(view, gate_rad, [&](const PaintSighting& sighting, const Line* line, double) {
      sums.cost += line ? cost_of(line->residual) : kCostOfNothing;
      if (!line) return;
      const Eigen::RowVector2d across = line->per_px * sighting.normal_px.transpose();
      RefinementRow row(line->residual, weight_of(line->residual));
      row.add_shared(camera * kCameraParameters,
                     only_free(camera, (across * line->point.of_camera).transpose()));
      row.add_shared(kFirstElement + 2 * elements_.at(sighting.element),
                     (across * line->point.of_point.leftCols<2>()).transpose().eval());
      row.add_frame(view.picture.frame, (across * line->point.of_frame).transpose());
      sums.add(row);
    });
  }
  for (const Ties& ties : ties_) {
    if (free_[ties.first.camera].none() || free_[ties.second.camera].none()) continue;
    visit(ties, gate_rad, [&](const TieRows* tie) {
      sums.cost += tie ? cost_of(tie->residual) : kCostOfNothing;
      if (!tie) return;
      for (const RefinementRow& row : tie->rows) sums.add(row);
    });
  }
  return sums;
}

/// Returns the information about the cameras without their priors. All other unknowns are
/// eliminated.
Eigen::MatrixXd RefinementProblem::camera_information(double gate_rad) const {
  const Eigen::MatrixXd all = EliminatedFrames(linearize(gate_rad)).information();
  const Eigen::Index rest = all.rows() - kCameraUnknowns;
  const Eigen::MatrixXd joint = all.topRightCorner(kCameraUnknowns, rest);
  const Eigen::MatrixXd result =
      all.topLeftCorner(kCameraUnknowns, kCameraUnknowns) -
      joint * all.bottomRightCorner(rest, rest).llt().solve(joint.transpose());
  return 0.5 * (result + result.transpose());
}

}  // namespace bevloc
