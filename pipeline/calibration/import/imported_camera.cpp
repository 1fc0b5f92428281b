#include "pipeline/calibration/import/imported_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/calibration/import/foreign_node.h"

namespace bevloc::calibration_import {

void set_pinhole_distortion(const std::vector<double>& coefficients, const std::string& place,
                            Intrinsics& intrinsics) {
  constexpr std::array<std::string_view, 14> kNames = {
      "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "taux", "tauy"};
  constexpr size_t kExpressed = 4;
  const size_t count = coefficients.size();
  constexpr std::array<size_t, 6> kCounts = {0, 4, 5, 8, 12, 14};
  if (std::ranges::find(kCounts, count) == kCounts.end()) {
    refuse(place, fmt::format("{} distortion coefficients", count),
           fmt::format("{} of them in OpenCV's order: {}", fmt::join(kCounts, ", "),
                       fmt::join(kNames, ", ")));
  }
  for (size_t i = kExpressed; i < count; ++i) {
    if (coefficients[i] == 0.0) continue;
    refuse(
        place, fmt::format("{} = {:g}", kNames[i], coefficients[i]),
        fmt::format("{} = 0, because bevloc's pinhole has k1, k2, p1 and p2; calibrate again "
                    "with {} fixed to 0 (OpenCV: CALIB_FIX_K3 without models of more coefficients)",
                    kNames[i], kNames[i]));
  }
  intrinsics.lens = Lens::kPinhole;
  if (count == 0) return;
  intrinsics.k1 = coefficients[0];
  intrinsics.k2 = coefficients[1];
  intrinsics.p1 = coefficients[2];
  intrinsics.p2 = coefficients[3];
}

void set_fisheye_distortion(const std::vector<double>& coefficients, const std::string& place,
                            Intrinsics& intrinsics) {
  if (coefficients.size() != 4) {
    refuse(place, fmt::format("{} distortion coefficients", coefficients.size()),
           "4 of a fisheye: k1, k2, k3, k4");
  }
  intrinsics.lens = Lens::kFisheye;
  intrinsics.k1 = coefficients[0];
  intrinsics.k2 = coefficients[1];
  intrinsics.k3 = coefficients[2];
  intrinsics.k4 = coefficients[3];
}

void set_camera_matrix(const std::vector<double>& rows, const std::string& place,
                       Intrinsics& intrinsics) {
  const bool is_upper = rows[3] == 0.0 && rows[6] == 0.0 && rows[7] == 0.0 && rows[8] == 1.0;
  if (rows[1] != 0.0 || !is_upper) {
    refuse(place, "a camera matrix with skew or another form",
           "fx, 0, cx, 0, fy, cy, 0, 0, 1 row by row");
  }
  intrinsics.fx_px = rows[0];
  intrinsics.cx_px = rows[2];
  intrinsics.fy_px = rows[4];
  intrinsics.cy_px = rows[5];
}

}  // namespace bevloc::calibration_import
