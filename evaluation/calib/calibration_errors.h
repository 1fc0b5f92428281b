// The errors that refinements leave in calibrations whose truth is known, over several drives.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pipeline/calibration/refine/refinement.h"

namespace bevloc::evaluation {

/// Collects what `bevloc eval calib` prints.
class CalibrationErrors {
 public:
  /// What a refinement should find for each camera.
  using Truth = std::array<CameraAdjustment, kCameraCount>;

  /// Judges the refinement of the drive with this seed.
  void add(uint64_t seed, const RigRefinement& refinement, const Truth& truth);

  /// Notes that the drive with this seed could not be refined. Its errors do not count.
  void leave_out(uint64_t seed, std::string_view why);

  /// The number of drives that were added.
  size_t drives() const { return drives_.size(); }

  /// A table with one row for each parameter.
  std::string to_table() const;

  /// {drives: [...], left_out: [{seed, why}], errors: {parameter: {...}}}.
  nlohmann::json to_json() const;

 private:
  /// The errors of one parameter over all cameras and drives. Cameras of which the parameter is not
  /// observable count in `cameras` only.
  struct ErrorSums {
    int cameras = 0;
    double squares_before = 0.0;  ///< sum of the squared errors before the refinement
    std::vector<double> errors;   ///< absolute errors after the refinement
    int within_sigma = 0;         ///< errors within one sigma
    int within_three = 0;
  };
  /// One row of the table, in the unit of the parameter.
  struct Row {
    size_t observable = 0;
    int cameras = 0;
    double rms_before = 0.0;
    double median_after = 0.0;
    double rms_after = 0.0;
    double share_within_sigma = 0.0;
    double share_within_three = 0.0;
  };

  void judge_camera(const CameraRefinement& camera, const CameraAdjustment& truth);
  Row row_of(size_t parameter) const;

  std::array<ErrorSums, kCameraParameters> sums_;
  std::vector<nlohmann::json> drives_;
  std::vector<nlohmann::json> left_out_;
};

}  // namespace bevloc::evaluation
