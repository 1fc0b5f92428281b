// Converts GNSS samples and matches to the pose measurements of the filter.
#pragma once

#include <Eigen/Core>

#include "pipeline/solver/solver_result.h"
#include "pipeline/tracker/gnss_pose.h"
#include "pipeline/tracker/pose_update.h"

namespace bevloc {

/// How the errors of matches and GNSS divide into noise and a correlated part.
struct MeasurementModel {
  /// Share of a match's variance that is correlated over distance: (x, y, yaw).
  Eigen::Vector3d match_correlated_share{0.7, 0.8, 0.5};
  /// Largest standard deviations of the error that consecutive matches share: (x m, y m, yaw rad).
  /// An uncertain match says little about the error of a certain one, so the rest of its error
  /// counts as noise (PoseMeasurement::uncommon_variance).
  Eigen::Vector3d match_common_sigma{0.25, 0.15, radians(0.3)};
  /// Standard deviations that are added to the correlated part of every match, because calibration
  /// and map have errors that the solver cannot see: (x m, y m, yaw rad).
  Eigen::Vector3d match_floor{0.05, 0.08, radians(0.12)};
  /// Standard deviations of the error that all matches of a drive share, from calibration and map:
  /// (x m, y m, yaw rad). No number of matches averages it out, so every pose has it.
  Eigen::Vector3d constant_error{0.08, 0.06, radians(0.08)};
  /// Share of a GNSS sample's variance that is correlated over time.
  double gnss_correlated_share = 0.9;
  /// A receiver that reports smaller sigmas is not trusted more.
  double gnss_min_position_sigma_m = 0.3;
  double gnss_min_yaw_sigma_rad = radians(0.3);

  bool operator==(const MeasurementModel&) const = default;
};

/// A sample without yaw gets a standard deviation of yaw that changes no estimate. `correlated`
/// says whether consecutive errors of GNSS are correlated at all.
PoseMeasurement measurement_from(const GnssPose& gnss, const MeasurementModel& model,
                                 bool correlated);

/// The standard deviations (x m, y m, yaw rad) of a pose that comes from one match. They combine
/// the match's own sigma with MeasurementModel::match_floor, because a match cannot see the errors
/// of map and calibration.
Eigen::Vector3d pose_sigma(const MatchResult& result, const MeasurementModel& model = {});

/// The pose prior * result.correction. `correlated` says for each axis whether consecutive errors
/// of matches are correlated at all. An axis without evidence gets a standard deviation that is 100
/// times as large.
PoseMeasurement measurement_from(const Se2& prior, const MatchResult& result,
                                 const MeasurementModel& model,
                                 const Eigen::Array<bool, 3, 1>& correlated);

}  // namespace bevloc
