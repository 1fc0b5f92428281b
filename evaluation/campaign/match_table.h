// Matches that were measured on simulated pictures, with their errors: what the modelled matcher of
// the campaign replays.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/result.h"
#include "common/se2.h"
#include "pipeline/localization/localizer.h"

namespace bevloc::evaluation {

/// One match of one frameset, from one prior.
struct MeasuredMatch {
  SearchRange range = SearchRange::kTracking;
  Se2 truth;  ///< the correction that leads to the true pose; may lie outside the search range
  Se2 found;  ///< the correction that the solver returned
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();        ///< of x m, y m, yaw rad
  Eigen::Vector3d correlation = Eigen::Vector3d::Zero();  ///< x-y, x-yaw, y-yaw
  // The following values are those of MatchResult. A vector has one value per axis.
  Eigen::Vector3d rival_peak = Eigen::Vector3d::Zero();
  Eigen::Vector3d edge_mass = Eigen::Vector3d::Zero();
  double score = 0.0;
  Eigen::Vector3d axis_score = Eigen::Vector3d::Zero();

  /// The matched pose in the frame of the true vehicle.
  Se2 error() const { return truth.inverse() * found; }
  /// The covariance in the frame of the prior, like MatchResult::covariance.
  Eigen::Matrix3d covariance() const;
};

/// One frameset of a recorded drive, with its matches from several priors.
struct MeasuredPlace {
  int drive = 0;
  int frame = 0;                 ///< number of the frameset in its drive
  double station_m = 0.0;        ///< distance driven since the start of the drive
  double curvature_radpm = 0.0;  ///< of the vehicle's path; 0 for a standing vehicle
  std::vector<MeasuredMatch> matches;
};

/// All measured places in the order of driving. The places of one drive follow each other.
struct MatchTable {
  std::vector<MeasuredPlace> places;
};

/// Reads a file that to_csv() wrote. Each of its drives must have matches of both ranges.
Result<MatchTable> read_match_table(const std::filesystem::path& file);

/// One line per match. Lengths in mm, angles in millidegrees, shares in percent.
std::string to_csv(const MatchTable& table);

}  // namespace bevloc::evaluation
