// Parameters of the solvers. Training learns them; the model file carries them.
#pragma once

namespace bevloc {

/// Every `*_scale` except sigma_scale and score_scale is an inverse temperature: p = softmax(scale
/// * score).
struct SolverParameters {
  float joint_scale = 100.0F;     ///< scale of the joint (2-D) score of all hypotheses
  float x_scale = 100.0F;         ///< scale of the ZNCC of the longitudinal profiles
  float y_scale = 100.0F;         ///< scale of the ZNCC of the lateral profiles
  float yaw_scale = 100.0F;       ///< scale of -MSE of the yaw features
  float refine_x_scale = 100.0F;  ///< scale of the refinement's ZNCC along each axis
  float refine_y_scale = 100.0F;
  float refine_yaw_scale = 100.0F;
  float banded_x_scale = 100.0F;  ///< scale of the correlation of the longitudinal bands
  float banded_y_scale = 100.0F;  ///< scale of the correlation of the lateral bands
  float sigma_scale = 1.0F;       ///< factor on the standard deviations of the covariance
  float score_scale = 1.0F;       ///< factor on SolverResult::score
  float gem_omega = 1.0F;         ///< GeM exponent of the axis features (paper, eq. 12)
};

}  // namespace bevloc
