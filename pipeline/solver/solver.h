// Pose solvers: where must the BEV features lie on the map features?
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/se2.h"
#include "pipeline/bev_grid.h"

namespace bevloc {

/// Borrowed features [channels, rows, cols] on a grid.
struct FeatureView {
  std::span<const float> data;
  int channels = 0;
  BevGrid grid;
};

/// Equally spaced hypotheses around zero: -range ... +range, or to the multiple of the step that is
/// nearest to the range (beyond it where two are as near).
struct HypothesisAxis {
  double range = 0.0;
  double step = 0.0;

  int count() const { return 2 * half_count() + 1; }
  int half_count() const { return static_cast<int>(range / step + 0.5); }
  double value(int i) const { return (i - half_count()) * step; }
  double farthest() const { return half_count() * step; }
};

/// The paper's sampling: 21 x 11 x 21 hypotheses.
struct HypothesisGrid {
  HypothesisAxis x_m{2.0, 0.2};
  HypothesisAxis y_m{1.0, 0.2};
  HypothesisAxis yaw_rad{radians(2.0), radians(0.2)};

  int count() const { return x_m.count() * y_m.count() * yaw_rad.count(); }
};

/// Why a solution may not be used.
enum class Evidence {
  kGood,  ///< use it
  kNone,  ///< a side is constant, empty or not finite: there is nothing to match
};

/// What a solution says about the pose.
struct Correction {
  Evidence evidence = Evidence::kNone;
  Se2 correction;  ///< dT = T0^-1 T, zero without evidence
  /// Covariance of the correction, in T0's frame: (x m, y m, yaw rad). It holds the hypotheses'
  /// even odds as a prior.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Per axis: the share of the hypotheses' variance that the match removed. 0 or less: nothing was
  /// seen along it; near 1: as well as the steps resolve.
  Eigen::Vector3d evidence_share = Eigen::Vector3d::Ones();
};

/// `correction` is the mean of the distributions.
struct SolverResult : Correction {
  /// Where a parabola through the logarithms of each axis's best hypothesis and its neighbours has
  /// its top; zero without evidence.
  Se2 parabola;
  /// Per axis (x, y, yaw): the probability of the next highest peak against that of the highest.
  /// 0: a single peak; 1: two that are as likely.
  Eigen::Vector3d rival_peak = Eigen::Vector3d::Zero();
  /// Probabilities over the hypotheses of each axis; each sums to 1.
  std::vector<float> x_probability;
  std::vector<float> y_probability;
  std::vector<float> yaw_probability;
};

/// What training learned for the solver; it travels in the model file.
struct SolverParameters {
  float joint_scale = 100.0F;     ///< inverse temperature of the joint (2-D) ZNCC
  float x_scale = 100.0F;         ///< of the longitudinal axis ZNCC
  float y_scale = 100.0F;         ///< of the lateral axis ZNCC
  float yaw_scale = 100.0F;       ///< of the yaw features' -MSE
  float refine_x_scale = 100.0F;  ///< of the refinement's ZNCC along each axis
  float refine_y_scale = 100.0F;
  float refine_yaw_scale = 100.0F;
  float banded_x_scale = 100.0F;  ///< of the longitudinal bands' correlation
  float banded_y_scale = 100.0F;  ///< of the lateral bands' correlation
  float sigma_scale = 1.0F;       ///< of the claimed deviations: features err in ways of their own
  float gem_omega = 1.0F;         ///< GeM exponent of the axis features (eq. 12)
};

/// Scratch memory is made in the constructor; solve() allocates nothing once `result` has been
/// filled before. Not thread safe.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Finds the correction under which `bev` (perceived, vehicle frame) lies best on `map` (drawn at
  /// T0). Both must have the grid and channels the solver was made for. Never gives a NaN.
  virtual void solve(const FeatureView& bev, const FeatureView& map, SolverResult& result) = 0;
};

}  // namespace bevloc
