// One camera as another program's calibration has it, in bevloc's conventions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/calibration/camera_model.h"

namespace bevloc::calibration_import {

/// Where a file places a camera. `parent` is "vehicle", "imu" or "world"; with `is_on_camera` it is
/// the name of another camera of the file.
struct Mounting {
  std::string parent;
  Se3 parent_from_camera;
  bool is_on_camera = false;
};

struct ImportedCamera {
  std::string name;       ///< name in the file that it comes from
  std::string place;      ///< "file:line: key"
  Intrinsics intrinsics;  ///< width_px is 0 where the format lacks the size of the images
  std::optional<Mounting> mounting{};
  std::string lens_place{};  ///< place of the intrinsics, if they come from another place
  /// The stem of the file or of the picture that the camera comes from. Empty if it says nothing
  /// about the camera's name.
  std::string file_stem{};
  std::string lens_doubt{};  ///< remark for the user, if the file does not say which lens it means

  const std::string& place_of_lens() const { return lens_place.empty() ? place : lens_place; }
};

/// Sets the distortion k1, k2, p1 and p2 from coefficients in OpenCV's order. Refuses further ones
/// (k3 to k6, thin prism, tilt) other than 0, which bevloc's camera model does not have, and a
/// number of coefficients that OpenCV does not write.
void set_pinhole_distortion(const std::vector<double>& coefficients, const std::string& place,
                            Intrinsics& intrinsics);

/// Sets k1 to k4 of a fisheye (cv::fisheye, equidistant).
void set_fisheye_distortion(const std::vector<double>& coefficients, const std::string& place,
                            Intrinsics& intrinsics);

/// Sets focal lengths and principal point from a 3 x 3 matrix, row by row. Refuses skew.
void set_camera_matrix(const std::vector<double>& rows, const std::string& place,
                       Intrinsics& intrinsics);

inline constexpr int kLargestImage_px = 16384;

}  // namespace bevloc::calibration_import
