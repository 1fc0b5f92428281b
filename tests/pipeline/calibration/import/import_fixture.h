// Files and checks of the tests of the import.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pipeline/calibration/import/import_rig.h"
#include "tests/support/demo_rig.h"
#include "tests/support/text.h"

namespace bevloc::test {

inline RigImportOptions with_base() {
  RigImportOptions options;
  options.base = demo_rig();
  return options;
}

inline void expect_refused(const std::vector<ForeignFile>& files, const RigImportOptions& options,
                           const std::string& part) {
  const auto imported = import_rig(files, options);
  ASSERT_FALSE(imported) << part;
  EXPECT_NE(imported.error().message.find(part), std::string::npos) << imported.error().message;
}

inline const std::string kCameraInfo = R"(image_width: 1280
image_height: 720
camera_name: front
camera_matrix:
  rows: 3
  cols: 3
  data: [900.5, 0, 640.25, 0, 901.5, 361.75, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.12, 0.03, 0.001, -0.002, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
)";

/// A chain in which cam0 has the IMU and cam1 hangs on cam0.
inline std::string kalibr_chain(const Se3& camera0_from_imu, const Se3& camera1_from_camera0) {
  const auto rows = [](const Se3& t) {
    std::string text;
    for (int r = 0; r < 3; ++r) {
      text += fmt::format("  - [{:.12f}, {:.12f}, {:.12f}, {:.12f}]\n", t.rotation(r, 0),
                          t.rotation(r, 1), t.rotation(r, 2), t.translation_m[r]);
    }
    return text + "  - [0.0, 0.0, 0.0, 1.0]\n";
  };
  return "cam0:\n  T_cam_imu:\n" + rows(camera0_from_imu) +
         "  cam_overlaps: [1]\n  camera_model: pinhole\n"
         "  distortion_coeffs: [-0.1, 0.01, 0.001, 0.002]\n  distortion_model: radtan\n"
         "  intrinsics: [510.0, 511.0, 330.0, 180.0]\n  resolution: [640, 360]\n"
         "  rostopic: /front/image_raw\n"
         "cam1:\n  T_cn_cnm1:\n" +
         rows(camera1_from_camera0) +
         "  camera_model: pinhole\n  distortion_coeffs: [0.01, 0.02, 0.0, 0.0]\n"
         "  distortion_model: equidistant\n  intrinsics: [400.0, 400.0, 320.0, 180.0]\n"
         "  resolution: [640, 360]\n  rostopic: /side/image_raw\n";
}

}  // namespace bevloc::test
