#include "pipeline/calibration/refine/refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "common/median.h"

namespace bevloc {
namespace {

constexpr double kAgrees = 3.0;  // sigmas
/// A camera with fewer sightings and ties that agree keeps its calibration.
constexpr int kLeastSightings = 100;

double median_if_any(std::vector<double>& values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : median(values);
}

/// Whether a mount or a lens can change this much. A camera that may change more can also fit the
/// paint of wrong lines.
bool is_plausible(const CameraAdjustment& change) {
  constexpr double kMostOfExpected = 3.0;
  for (int p = 0; p < kCameraParameters; ++p) {
    const double expected = kCameraParameterInfos[static_cast<size_t>(p)].expected_error;
    if (std::abs(change[p]) > kMostOfExpected * expected) return false;
  }
  return true;
}

}  // namespace

RefinementProblem::RefinementProblem(const Rig& rig, const ReferenceTrajectory& reference,
                                     const RefinementOptions& options)
    : rig_(rig), reference_(reference), options_(options) {
  free_.fill(options.free);
  estimate_.changes.fill(CameraAdjustment::Zero());
}

void RefinementProblem::clear_sightings() {
  views_.clear();
  ties_.clear();
}

void RefinementProblem::add(int frame, int camera, Time time,
                            std::vector<PaintSighting> sightings) {
  while (static_cast<int>(estimate_.frames.size()) <= frame) {
    const auto pose = reference_.at(time);
    estimate_.frames.push_back(
        {FrameVector::Zero(), acceleration_at(time), time, pose ? pose->yaw_rad : 0.0});
  }
  for (const PaintSighting& sighting : sightings) {
    const int next = static_cast<int>(elements_.size());
    if (elements_.emplace(sighting.element, next).second) {
      estimate_.shifts.push_back(Eigen::Vector2d::Zero());
    }
  }
  views_.push_back({{frame, camera, time}, std::move(sightings)});
}

void RefinementProblem::add_ties(const Picture& first, const Picture& second,
                                 std::vector<GroundTie> ties) {
  ties_.push_back({first, second, std::move(ties)});
}

std::optional<MomentView> RefinementProblem::expected_view(const Picture& picture) const {
  return view_of(picture, expected_error(picture.frame));
}

void RefinementProblem::restart_frames() {
  for (Frame& frame : estimate_.frames) frame.error = expected_error(frame);
}

Se3 RefinementProblem::expected_body_from_vehicle(int frame) const {
  return body_from_vehicle(expected_error(frame));
}

/// The acceleration in the vehicle frame, from the reference positions. It is 0 if they are not
/// known.
Eigen::Vector2d RefinementProblem::acceleration_at(Time time) const {
  constexpr Duration kAround = std::chrono::milliseconds(500);
  const auto pose = reference_.at(time);
  const auto before = reference_.at(time - kAround);
  const auto after = reference_.at(time + kAround);
  if (!pose || !before || !after) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d in_map =
      (before->translation() - 2.0 * pose->translation() + after->translation()) /
      (to_seconds(kAround) * to_seconds(kAround));
  return Se2{0.0, 0.0, -pose->yaw_rad} * in_map;
}

FrameVector RefinementProblem::frame_sigma() const {
  FrameVector sigma;
  sigma << options_.body_tilt_rad, options_.body_tilt_rad, options_.reference_yaw_rad,
      options_.reference_position_m, options_.reference_position_m, options_.body_lift_m;
  return sigma;
}

FrameVector RefinementProblem::expected_error(const Frame& frame) const {
  FrameVector expected = estimate_.mean;
  expected[0] += estimate_.tilt_per_acceleration[0] * frame.acceleration_mps2.y();
  expected[1] += estimate_.tilt_per_acceleration[1] * frame.acceleration_mps2.x();
  return expected;
}

FrameVector RefinementProblem::expected_error(int frame) const {
  const auto k = static_cast<size_t>(frame);
  return k < estimate_.frames.size() ? expected_error(estimate_.frames[k])
                                     : FrameVector(FrameVector::Zero());
}

/// Prior information of each parameter. It is so large that a parameter that is not free stays as
/// it is.
Eigen::VectorXd RefinementProblem::camera_prior() const {
  constexpr double kFixed = 1e12;
  Eigen::VectorXd prior(kCameraUnknowns);
  for (int i = 0; i < kCameraUnknowns; ++i) {
    const auto parameter = static_cast<size_t>(i % kCameraParameters);
    const double sigma = kCameraParameterInfos[parameter].expected_error;
    const bool is_free = free_[static_cast<size_t>(i / kCameraParameters)][parameter];
    prior[i] = (is_free ? 1.0 : kFixed) / (sigma * sigma);
  }
  return prior;
}

/// Moves all unknowns. Those of the framesets follow from the others.
void RefinementProblem::move(const EliminatedFrames& eliminated, const Eigen::VectorXd& by) {
  for (int c = 0; c < kCameraCount; ++c) {
    estimate_.changes[c] += by.segment<kCameraParameters>(c * kCameraParameters);
  }
  estimate_.mean += by.segment<kFrameUnknowns>(kCameraUnknowns);
  estimate_.tilt_per_acceleration +=
      by.segment<kTiltsPerAcceleration>(kCameraUnknowns + kFrameUnknowns);
  for (int c = 0; c < kCameraCount; ++c) estimate_.heights_m[c] += by[kFirstHeight + c];
  for (size_t i = 0; i < estimate_.shifts.size(); ++i) {
    estimate_.shifts[i] += by.segment<2>(static_cast<Eigen::Index>(kFirstElement + 2 * i));
  }
  const std::vector<FrameVector> of_frames = eliminated.changes(by);
  for (size_t k = 0; k < estimate_.frames.size(); ++k) estimate_.frames[k].error += of_frames[k];
}

/// One step of Levenberg-Marquardt. Returns whether another one may still improve the estimate.
bool RefinementProblem::step(double gate_rad, double& damping) {
  constexpr double kMostDamping = 1e4;
  constexpr double kConverged = 1e-3;  // share of the expected errors
  const Eigen::VectorXd prior = camera_prior();
  const auto cost_of = [&](const RefinementSums& sums) {
    double cost = sums.cost;
    for (int c = 0; c < kCameraCount; ++c) {
      const auto weight = prior.segment<kCameraParameters>(c * kCameraParameters);
      cost += 0.5 * estimate_.changes[c].dot(weight.cwiseProduct(estimate_.changes[c]));
    }
    return cost;
  };
  const RefinementSums sums = linearize(gate_rad);
  const double cost = cost_of(sums);
  const EliminatedFrames eliminated(sums);
  Eigen::MatrixXd information = eliminated.information();
  Eigen::VectorXd gradient = eliminated.gradient();
  information.diagonal().head<kCameraUnknowns>() += prior;
  for (int c = 0; c < kCameraCount; ++c) {
    const Eigen::Index first = c * kCameraParameters;
    gradient.segment<kCameraParameters>(first) +=
        prior.segment<kCameraParameters>(first).cwiseProduct(estimate_.changes[c]);
  }
  const Estimate before = estimate_;
  for (; damping < kMostDamping; damping *= 10.0) {
    Eigen::MatrixXd damped = information;
    damped.diagonal() += damping * information.diagonal();
    const Eigen::VectorXd by = -damped.llt().solve(gradient);
    move(eliminated, by);
    if (cost_of(linearize(gate_rad)) < cost) {
      damping = std::max(1e-6, 0.1 * damping);
      return by.head<kCameraUnknowns>().cwiseAbs2().cwiseProduct(prior).maxCoeff() >
             kConverged * kConverged;
    }
    estimate_ = before;
  }
  return false;
}

void RefinementProblem::solve(double gate_rad, double sigma_scale) {
  sigma_scale_ = sigma_scale;
  constexpr int kMostSteps = 20;
  double damping = 1e-4;
  for (int i = 0; i < kMostSteps && step(gate_rad, damping); ++i) {
  }
}

std::array<int, kCameraCount> RefinementProblem::agreeing_ties(double gate_rad) const {
  std::array<int, kCameraCount> count{};
  for (const Ties& ties : ties_) {
    visit(ties, gate_rad, [&](const TieRows* tie) {
      if (!tie || tie->residual > kAgrees) return;
      ++count[ties.first.camera];
      if (ties.second.camera != ties.first.camera) ++count[ties.second.camera];
    });
  }
  return count;
}

/// Leaves out cameras that see too little or would change too much. Returns whether it has left out
/// further cameras.
bool RefinementProblem::leave_out_doubtful(double gate_rad) {
  std::array<int, kCameraCount> seen = agreeing_ties(gate_rad);
  for (const View& view : views_) {
    visit(view, gate_rad, [&](const PaintSighting&, const Line* line, double) {
      if (line && std::abs(line->residual) <= kAgrees) ++seen[view.picture.camera];
    });
  }
  bool any = false;
  for (int c = 0; c < kCameraCount; ++c) {
    if (free_[c].none() || (seen[c] >= kLeastSightings && is_plausible(estimate_.changes[c])))
      continue;
    free_[c].reset();
    unobservable_[c] = options_.free;
    estimate_.changes[c].setZero();
    any = true;
  }
  return any;
}

void RefinementProblem::find_unobservable(double gate_rad) {
  // With this information, in units of the expected error, the recording's own sigma is half that
  // error.
  constexpr double kLeastInformation = 4.0;
  const Eigen::VectorXd scale = camera_prior().cwiseInverse().cwiseSqrt();
  const Eigen::MatrixXd information =
      scale.asDiagonal() * camera_information(gate_rad) * scale.asDiagonal();
  std::vector<int> indices;
  for (int i = 0; i < kCameraUnknowns; ++i) {
    if (free_[i / kCameraParameters][static_cast<size_t>(i % kCameraParameters)]) {
      indices.push_back(i);
    }
  }
  while (!indices.empty()) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(information(indices, indices));
    if (parts.eigenvalues()[0] >= kLeastInformation) return;
    Eigen::Index largest = 0;
    parts.eigenvectors().col(0).cwiseAbs().maxCoeff(&largest);
    const int worst = indices[static_cast<size_t>(largest)];
    unobservable_[worst / kCameraParameters].set(static_cast<size_t>(worst % kCameraParameters));
    indices.erase(indices.begin() + largest);
  }
}

/// Sets the change of unobservable parameters to 0 and estimates the other parameters of their
/// cameras again (Gauss-Newton). All other unknowns keep their estimate, so the cameras are
/// independent.
void RefinementProblem::keep_unobservable(double gate_rad) {
  constexpr int kSteps = 5;
  for (int c = 0; c < kCameraCount; ++c) {
    for (int p = 0; p < kCameraParameters; ++p) {
      if (unobservable_[c][static_cast<size_t>(p)]) estimate_.changes[c][p] = 0.0;
    }
  }
  for (int i = 0; i < kSteps; ++i) {
    const RefinementSums sums = linearize(gate_rad);
    for (int c = 0; c < kCameraCount; ++c) {
      if (free_[c].any() && unobservable_[c].any()) step_alone(c, sums);
    }
  }
}

/// Takes one Gauss-Newton step for a camera's observable parameters and for the height of the
/// ground that its ties show.
void RefinementProblem::step_alone(int camera, const RefinementSums& sums) {
  const Eigen::VectorXd prior = camera_prior();
  CameraAdjustment& change = estimate_.changes[camera];
  Eigen::MatrixXd information = sums.information;
  Eigen::VectorXd gradient = sums.gradient;
  std::vector<Eigen::Index> unknowns;
  for (int p = 0; p < kCameraParameters; ++p) {
    if (unobservable_[camera][static_cast<size_t>(p)]) continue;
    const Eigen::Index unknown = camera * kCameraParameters + p;
    information(unknown, unknown) += prior[unknown];
    gradient[unknown] += prior[unknown] * change[p];
    unknowns.push_back(unknown);
  }
  unknowns.push_back(kFirstHeight + camera);
  const Eigen::MatrixXd part = information(unknowns, unknowns);
  const Eigen::VectorXd by = -part.llt().solve(gradient(unknowns));
  for (size_t i = 0; i + 1 < unknowns.size(); ++i) {
    change[unknowns[i] % kCameraParameters] += by[static_cast<Eigen::Index>(i)];
  }
  estimate_.heights_m[camera] += by[by.size() - 1];
}

void RefinementProblem::finish(double gate_rad) {
  do {
    solve(gate_rad);
  } while (leave_out_doubtful(gate_rad));
  find_unobservable(gate_rad);
  keep_unobservable(gate_rad);
}

RigRefinement RefinementProblem::result(double gate_rad) const {
  constexpr double kEverywhere_rad = 1.0;
  RigRefinement result;
  result.frames = static_cast<int>(estimate_.frames.size());
  Eigen::MatrixXd information = camera_information(gate_rad);
  information.diagonal() += camera_prior();
  const Eigen::VectorXd variance = information.inverse().diagonal();
  RefinementProblem unchanged = *this;
  unchanged.estimate_.changes.fill(CameraAdjustment::Zero());
  std::array<std::vector<double>, kCameraCount> before;
  std::array<std::vector<double>, kCameraCount> after;
  std::set<const PaintSighting*> agreeing;
  for (const View& view : views_) {
    CameraRefinement& camera = result.cameras[view.picture.camera];
    visit(view, gate_rad, [&](const PaintSighting& sighting, const Line* line, double distance_px) {
      ++camera.looked_at;
      if (!line || std::abs(line->residual) > kAgrees) return;
      ++camera.found;
      agreeing.insert(&sighting);
      after[view.picture.camera].push_back(std::abs(distance_px));
    });
    unchanged.visit(view, kEverywhere_rad,
                    [&](const PaintSighting& sighting, const Line*, double distance_px) {
                      if (!agreeing.contains(&sighting)) return;
                      before[view.picture.camera].push_back(std::abs(distance_px));
                    });
  }
  const std::array<int, kCameraCount> ties = agreeing_ties(gate_rad);
  for (int c = 0; c < kCameraCount; ++c) {
    CameraRefinement& camera = result.cameras[c];
    camera.ties = ties[c];
    camera.change = estimate_.changes[c];
    camera.unobservable = unobservable_[c];
    camera.kept = ~options_.free;
    camera.sigma = variance.segment<kCameraParameters>(c * kCameraParameters).cwiseSqrt();
    camera.before_px = median_if_any(before[c]);
    camera.after_px = median_if_any(after[c]);
  }
  return result;
}

}  // namespace bevloc
