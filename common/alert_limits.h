// Errors beyond which a pose is dangerous.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "common/se2.h"

namespace bevloc {

/// Alert limits of a freeway: longitudinal m, lateral m, yaw rad. Source: Reid et al.,
/// "Localization Requirements for Autonomous Vehicles" (2019).
inline const Eigen::Vector3d kFreewayAlertLimits{1.40, 0.57, radians(1.50)};

inline bool is_beyond(const Eigen::Vector3d& error, const Eigen::Vector3d& limits) {
  return (error.cwiseAbs() - limits).maxCoeff() > 0.0;
}

}  // namespace bevloc
