#include <array>

#include <fmt/format.h>

#include "pipeline/calibration/import/readers.h"

namespace bevloc::calibration_import {
namespace {

/// Returns the value of the first of these keys that the document has. If it has none, the error
/// names the first key.
ForeignNode first_of(const ForeignNode& document, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (document.has(key)) return document.at(key);
  }
  return document.at(*keys.begin());
}

/// The numbers of a matrix with rows, cols and data. A `count` of 0 allows any number of them.
std::vector<double> matrix_data(const ForeignNode& matrix, size_t count) {
  const int rows = matrix.at("rows").whole_number(0, 100);
  const int cols = matrix.at("cols").whole_number(0, 100);
  const ForeignNode data = matrix.at("data");
  const auto numbers = data.numbers(count);
  if (numbers.size() != static_cast<size_t>(rows) * static_cast<size_t>(cols)) {
    data.reject(fmt::format("{} numbers", numbers.size()),
                fmt::format("{} rows of {}", rows, cols));
  }
  return numbers;
}

void read_size(const ForeignNode& document, Intrinsics& lens) {
  if (!document.has("image_width") && !document.has("image_height")) return;
  lens.width_px = document.at("image_width").whole_number(1, kLargestImage_px);
  lens.height_px = document.at("image_height").whole_number(1, kLargestImage_px);
}

ImportedCamera camera_of(const ForeignNode& document, const std::string& stem,
                         const Intrinsics& lens) {
  const bool is_named = document.has("camera_name");
  ImportedCamera camera{is_named ? document.at("camera_name").text() : stem, document.place(),
                        lens};
  camera.file_stem = stem;
  return camera;
}

/// In ROS, the camera matrix belongs to the full image, even if the driver delivers a part of it or
/// fewer pixels. The file does not say how pixels are combined, so the matrix cannot be converted.
void refuse_other_pictures(const ForeignNode& document, const Intrinsics& lens) {
  constexpr std::string_view kWanted =
      ", because the camera matrix is that of the full image; calibrate with the pictures as the "
      "driver delivers them, or let it deliver full images and remove binning and roi here";
  for (const std::string_view key : {"binning_x", "binning_y"}) {
    if (!document.has(key)) continue;
    const ForeignNode binning = document.at(key);
    const int pixels = binning.whole_number(0, kLargestImage_px);
    if (pixels > 1) binning.reject(std::to_string(pixels), fmt::format("0 or 1{}", kWanted));
  }
  if (!document.has("roi") || !document.at("roi").is_map()) return;
  const ForeignNode roi = document.at("roi");
  const auto check = [&](std::string_view key, int full_px) {
    if (!roi.has(key)) return;
    const int found = roi.at(key).whole_number(0, kLargestImage_px);
    if (found == 0 || found == full_px) return;
    const std::string_view or_full = full_px == 0 ? "0" : "0 or the size of the image";
    roi.at(key).reject(std::to_string(found), fmt::format("{}{}", or_full, kWanted));
  };
  check("x_offset", 0);
  check("y_offset", 0);
  check("width", lens.width_px);
  check("height", lens.height_px);
}

}  // namespace

ImportedCamera read_opencv(const ForeignNode& document, const std::string& stem) {
  Intrinsics lens;
  read_size(document, lens);
  const ForeignNode matrix = first_of(document, {"camera_matrix", "K"});
  set_camera_matrix(matrix_data(matrix, 9), matrix.place(), lens);
  const ForeignNode distortion =
      first_of(document, {"distortion_coefficients", "distortion", "dist_coeffs", "D"});
  const bool fisheye =
      document.has("fisheye_model") && document.at("fisheye_model").whole_number(0, 1) == 1;
  const auto set = fisheye ? set_fisheye_distortion : set_pinhole_distortion;
  const std::vector<double> coefficients = matrix_data(distortion, 0);
  set(coefficients, distortion.at("data").place(), lens);
  ImportedCamera camera = camera_of(document, stem, lens);
  // A pinhole and a fisheye of OpenCV may both have four coefficients, and only OpenCV's own
  // calibration tool writes which of them it is.
  if (coefficients.size() == 4 && !document.has("fisheye_model")) {
    camera.lens_doubt = "but if it is a fisheye of OpenCV, add `fisheye_model: 1` to the file";
  }
  return camera;
}

ImportedCamera read_camera_info(const ForeignNode& document, const std::string& stem) {
  Intrinsics lens;
  read_size(document, lens);
  refuse_other_pictures(document, lens);
  const ForeignNode matrix = document.at("camera_matrix");
  set_camera_matrix(matrix_data(matrix, 9), matrix.place(), lens);
  const ForeignNode model = document.at("distortion_model");
  const ForeignNode distortion = document.at("distortion_coefficients");
  const std::string kind = model.text();
  if (kind == "equidistant") {
    set_fisheye_distortion(matrix_data(distortion, 0), distortion.at("data").place(), lens);
  } else if (kind == "plumb_bob" || kind == "rational_polynomial") {
    set_pinhole_distortion(matrix_data(distortion, 0), distortion.at("data").place(), lens);
  } else {
    model.reject(kind, "plumb_bob, rational_polynomial or equidistant");
  }
  return camera_of(document, stem, lens);
}

}  // namespace bevloc::calibration_import
