// Estimates the calibration of all cameras from the paint and the ground that a drive's pictures
// show.
#pragma once

#include <array>
#include <bitset>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/cameras.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "pipeline/calibration/refine/camera_adjustment.h"
#include "pipeline/calibration/refine/moment_view.h"
#include "pipeline/calibration/refine/paint_finder.h"
#include "pipeline/calibration/refine/refinement_sums.h"
#include "pipeline/calibration/refine/tie_finder.h"
#include "pipeline/calibration/rig.h"

namespace bevloc {

using ParameterSet = std::bitset<kCameraParameters>;

struct RefinementOptions {
  ParameterSet free = ParameterSet().set();  ///< what may change
  // One sigma of the reference poses, and of the body against them.
  double reference_position_m = 0.03;
  double reference_yaw_rad = 0.1 * kPerDegree;
  double body_tilt_rad = 0.4 * kPerDegree;
  double body_lift_m = 0.02;
  /// One sigma of the place of a whole element of the map, along each axis.
  double map_m = 0.04;
};

struct CameraRefinement {
  CameraAdjustment change = CameraAdjustment::Zero();
  CameraAdjustment sigma = CameraAdjustment::Zero();
  /// Parameters that the recording does not determine. Their change is 0.
  ParameterSet unobservable;
  ParameterSet kept;  ///< parameters not in RefinementOptions::free; their change is 0
  int looked_at = 0;  ///< places where the map has paint
  int found = 0;      ///< places of these whose paint agrees after the refinement
  int ties = 0;       ///< tie points that agree after the refinement
  /// Median distance of the found paint from the map; NaN if none was found.
  double before_px = 0.0;
  double after_px = 0.0;
};

struct RigRefinement {
  std::array<CameraRefinement, kCameraCount> cameras;
  int frames = 0;
};

/// Robust least squares (Levenberg-Marquardt with the weights of Geman and McClure). The unknowns,
/// each with a Gaussian prior (RefinementOptions, kCameraParameterInfos, refinement_rows.cpp):
/// - eight parameters of each camera;
/// - six of each frameset, which all cameras share: an error of its reference pose, and tilt and
///   lift of the body. The error of the reference pose drifts from one frameset to the next (a
///   first-order Gauss-Markov process). These unknowns are eliminated by their Schur complement;
/// - the mean of these six over the drive, and how much the body tilts per acceleration;
/// - for each camera the height of the ground that its ties show, because a pavement is higher than
///   the road;
/// - the shift of each element of the map.
///
/// The directions of change are the eigenvectors of the information about the cameras, in units of
/// the expected errors. If the recording determines a direction no better than to half the expected
/// error, the parameter with the largest part in this direction is unobservable. Its change is 0,
/// and the other parameters of its camera are estimated again. A camera keeps all its values, and
/// its sightings and ties do not count, if fewer than 100 of them agree or if one of its parameters
/// would change by more than three expected errors.
class RefinementProblem {
 public:
  /// `rig` and `reference` must outlive the problem.
  RefinementProblem(const Rig& rig, const ReferenceTrajectory& reference,
                    const RefinementOptions& options);

  /// Forgets all sightings and ties, but keeps the estimate.
  void clear_sightings();

  /// Adds what one camera saw. `frame` counts framesets from 0. The reference must cover `time`.
  void add(int frame, int camera, Time time, std::vector<PaintSighting> sightings);

  /// One picture: its frameset (counted from 0), its camera and its time stamp.
  struct Picture {
    int frame;
    int camera;
    Time time;
  };

  /// Adds tie points of two pictures, of the same frameset or of two that follow each other.
  void add_ties(const Picture& first, const Picture& second, std::vector<GroundTie> ties);

  /// Returns the view that the estimate of the camera predicts, with the error of the frameset that
  /// the mean of the drive and the acceleration predict. Returns nothing if the reference does not
  /// cover the time.
  std::optional<MomentView> expected_view(const Picture& picture) const;

  /// Improves the estimate with the sightings and ties that are at most `gate_rad` times the focal
  /// length from where the estimate has them. The sigma of where they are found is `sigma_scale`
  /// times the usual one: a large one for a rig that may be far off.
  void solve(double gate_rad, double sigma_scale = 1.0);

  /// Sets the error of each frameset's pose and body to the one expected from the mean of the drive
  /// and from the acceleration. A frameset that fitted wrong paint can then leave it.
  void restart_frames();

  /// Solves with the usual sigma, leaves out doubtful cameras, and sets the change of unobservable
  /// parameters to 0.
  void finish(double gate_rad);

  const CameraAdjustment& change(int camera) const { return estimate_.changes[camera]; }

  /// The transform from the vehicle frame of a frameset's reference pose to that of its tilted
  /// body, as expected from the mean of the drive and from the acceleration. It is the identity if
  /// the frameset was not added yet.
  Se3 expected_body_from_vehicle(int frame) const;

  RigRefinement result(double gate_rad) const;

 private:
  static constexpr int kCameraUnknowns = kCameraCount * kCameraParameters;
  static constexpr int kTiltsPerAcceleration = 2;
  // Indices among the unknowns that do not belong to a single frameset.
  static constexpr int kFirstHeight = kCameraUnknowns + kFrameUnknowns + kTiltsPerAcceleration;
  static constexpr int kFirstElement = kFirstHeight + kCameraCount;

  struct Frame {
    FrameVector error = FrameVector::Zero();
    /// Acceleration of the vehicle along x and y.
    Eigen::Vector2d acceleration_mps2 = Eigen::Vector2d::Zero();
    Time time;
    double reference_yaw_rad = 0.0;
  };
  struct Estimate {
    std::array<CameraAdjustment, kCameraCount> changes;
    std::vector<Frame> frames;
    FrameVector mean = FrameVector::Zero();
    /// Roll per acceleration along y, and pitch per acceleration along x.
    Eigen::Vector2d tilt_per_acceleration = Eigen::Vector2d::Zero();
    /// Height above the road of the ground that a camera's ties show.
    std::array<double, kCameraCount> heights_m{};
    std::vector<Eigen::Vector2d> shifts;  ///< shifts of the map's elements
  };
  struct View {
    Picture picture;
    std::vector<PaintSighting> sightings;
  };
  struct Ties {
    Picture first;
    Picture second;
    std::vector<GroundTie> ties;
  };
  /// One linearized sighting.
  struct Line {
    double residual;  ///< in sigmas
    double per_px;    ///< sigmas per pixel along the normal
    PointView point;
  };
  /// One linearized tie.
  struct TieRows {
    double residual;  ///< distance of the two places on the ground, in sigmas
    std::array<RefinementRow, 2> rows;
  };

  /// Calls visitor(sighting, line or null, distance in pixels) for each sighting of a view.
  using Visitor = std::function<void(const PaintSighting&, const Line*, double)>;
  void visit(const View& view, double gate_rad, const Visitor& visitor) const;
  /// Calls visitor(rows or null) for each tie. Null means that its two places are too far from each
  /// other.
  using TieVisitor = std::function<void(const TieRows*)>;
  void visit(const Ties& ties, double gate_rad, const TieVisitor& visitor) const;
  std::optional<MomentView> view_of(const Picture& picture, const FrameVector& frame_error) const;
  std::optional<TieRows> linearize(const GroundTie& tie, const Ties& ties, const MomentView& first,
                                   const MomentView& second, double gate_rad) const;
  CameraAdjustment only_free(int camera, CameraAdjustment slope) const;
  /// Returns the sums without the priors of the cameras.
  RefinementSums linearize(double gate_rad) const;
  void add_priors(RefinementSums& sums) const;
  void add_frame_prior(size_t k, RefinementSums& sums) const;
  Eigen::MatrixXd camera_information(double gate_rad) const;
  Eigen::VectorXd camera_prior() const;
  void move(const EliminatedFrames& eliminated, const Eigen::VectorXd& by);
  bool step(double gate_rad, double& damping);
  std::array<int, kCameraCount> agreeing_ties(double gate_rad) const;
  bool leave_out_doubtful(double gate_rad);
  void find_unobservable(double gate_rad);
  void keep_unobservable(double gate_rad);
  void step_alone(int camera, const RefinementSums& sums);
  Eigen::Vector2d acceleration_at(Time time) const;
  FrameVector frame_sigma() const;
  FrameVector expected_error(const Frame& frame) const;
  /// Returns 0 if the frameset was not added yet.
  FrameVector expected_error(int frame) const;

  const Rig& rig_;
  const ReferenceTrajectory& reference_;
  const RefinementOptions options_;
  std::array<ParameterSet, kCameraCount> free_;  ///< none if the camera is left out
  std::array<ParameterSet, kCameraCount> unobservable_;
  Estimate estimate_;
  std::map<uint32_t, int> elements_;  ///< our index by the map's index
  std::vector<View> views_;
  std::vector<Ties> ties_;
  double sigma_scale_ = 1.0;  ///< sigma_scale of the latest solve()
};

}  // namespace bevloc
