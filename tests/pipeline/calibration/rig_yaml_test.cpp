#include "pipeline/calibration/rig_yaml.h"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/sim_rig.h"
#include "tests/support/pose_matchers.h"

namespace bevloc {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Rig any_rig() {
  Rig rig = sim::nominal_rig();
  for (int i = 0; i < kCameraCount; ++i) {
    CameraModel& camera = rig.cameras[i];
    camera.intrinsics = {.width_px = 640,
                         .height_px = 360,
                         .fx_px = 500.0 + i,
                         .fy_px = 501.0,
                         .cx_px = 320.25,
                         .cy_px = 180.125,
                         .k1 = -0.1,
                         .k2 = 0.01,
                         .p1 = 1e-4,
                         .p2 = -2e-4};
    camera.vehicle_from_camera.translation_m = {1.5 - 0.3 * i, 0.4, 1.5};
    const Eigen::AngleAxisd tilt(0.1 + 0.02 * i, Eigen::Vector3d(1, 2, 3).normalized());
    camera.vehicle_from_camera.rotation = tilt * camera.vehicle_from_camera.rotation;
  }
  return rig;
}

/// The error message after one replacement in a valid file.
std::string error_after(const std::string& from, const std::string& to) {
  std::string text = format_rig(any_rig());
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const auto rig = parse_rig(text, "rig.yaml");
  EXPECT_FALSE(rig.has_value()) << to;
  return rig ? "" : rig.error().message;
}

TEST(RigYaml, RoundTrips) {
  const Rig rig = any_rig();
  const auto again = parse_rig(format_rig(rig), "rig.yaml");
  ASSERT_TRUE(again.has_value()) << again.error().message;
  for (int i = 0; i < kCameraCount; ++i) {
    const CameraModel& a = rig.cameras[i];
    const CameraModel& b = again->cameras[i];
    EXPECT_EQ(a.intrinsics.width_px, b.intrinsics.width_px);
    EXPECT_EQ(a.intrinsics.height_px, b.intrinsics.height_px);
    EXPECT_NEAR(a.intrinsics.fx_px, b.intrinsics.fx_px, 1e-9);
    EXPECT_NEAR(a.intrinsics.fy_px, b.intrinsics.fy_px, 1e-9);
    EXPECT_NEAR(a.intrinsics.cx_px, b.intrinsics.cx_px, 1e-9);
    EXPECT_NEAR(a.intrinsics.cy_px, b.intrinsics.cy_px, 1e-9);
    EXPECT_NEAR(a.intrinsics.k1, b.intrinsics.k1, 1e-9);
    EXPECT_NEAR(a.intrinsics.k2, b.intrinsics.k2, 1e-9);
    EXPECT_NEAR(a.intrinsics.p1, b.intrinsics.p1, 1e-9);
    EXPECT_NEAR(a.intrinsics.p2, b.intrinsics.p2, 1e-9);
    EXPECT_THAT(b.vehicle_from_camera, test::RigidTransformNear(a.vehicle_from_camera, 1e-9, 1e-8));
  }
  EXPECT_EQ(format_rig(*again), format_rig(rig));
}

TEST(RigYaml, TheQuaternionRotatesCameraAxesIntoVehicleAxes) {
  Rig rig = any_rig();
  // Looks forward: z of the camera is x of the vehicle, x of the camera is -y of the vehicle.
  rig.cameras[1].vehicle_from_camera.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const std::string text = format_rig(rig);
  EXPECT_THAT(text, HasSubstr("rotation_wxyz: [0.5, -0.5, 0.5, -0.5]"));
  const auto again = parse_rig(text, "rig.yaml");
  ASSERT_TRUE(again.has_value());
  const Eigen::Vector3d ahead =
      again->cameras[1].vehicle_from_camera.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT((ahead - Eigen::Vector3d::UnitX()).norm(), 1e-9);
}

TEST(RigYaml, NamesLineKeyFoundAndWanted) {
  EXPECT_EQ(error_after("fx_px: 500\n", "fx_px: -3\n"),
            "rig.yaml:7: cameras.front_left.fx_px: found -3, wanted a number, more than 0");
}

TEST(RigYaml, RefusesBadNumbers) {
  EXPECT_THAT(error_after("fy_px: 501", "fy_px: 0"), HasSubstr("fy_px: found 0"));
  EXPECT_THAT(error_after("cx_px: 320.25", "cx_px: .nan"), HasSubstr("cx_px: found .nan"));
  EXPECT_THAT(error_after("cx_px: 320.25", "cx_px: 1e7"), HasSubstr("cx_px: found 1e7"));
  EXPECT_THAT(error_after("[640, 360]", "[640, 0]"), HasSubstr("image_size_px[1]: found 0"));
  EXPECT_THAT(error_after("[640, 360]", "[640]"), HasSubstr("wanted a list of 2"));
  EXPECT_THAT(error_after("[640, 360]", "[640, 360.5]"), HasSubstr("found 360.5"));
  EXPECT_THAT(error_after("[-0.1, 0.01,", "[-0.1, .inf,"), HasSubstr("distortion[1]: found .inf"));
  EXPECT_THAT(error_after("translation_m: [1.5,", "translation_m: [1500,"),
              HasSubstr("translation_m[0]: found 1500, wanted a number, -50 to 50"));
}

TEST(RigYaml, RefusesAQuaternionThatIsNotNormalised) {
  const std::string text = format_rig(any_rig());
  const size_t begin = text.find("rotation_wxyz");
  const std::string line = text.substr(begin, text.find('\n', begin) - begin);
  EXPECT_THAT(error_after(line, "rotation_wxyz: [1, 1, 0, 0]"),
              HasSubstr("rotation_wxyz: found a quaternion of norm 1.41421, wanted a unit"));
  EXPECT_THAT(error_after(line, "rotation_wxyz: [0, 0, 0, 0]"), HasSubstr("norm 0"));
  EXPECT_THAT(error_after(line, "rotation_wxyz: [1, 0, 0]"), HasSubstr("wanted a list of 4"));
}

TEST(RigYaml, RefusesADistortionThatIsNotMonotonicInTheImage) {
  EXPECT_THAT(error_after("[-0.1, 0.01,", "[-2.5, 0,"),
              HasSubstr("front_left.distortion: found a distortion that is not monotonic"));
}

TEST(RigYaml, RefusesMissingUnknownAndRepeatedKeys) {
  EXPECT_THAT(error_after("fx_px: 500\n", "fx_mm: 500\n"),
              HasSubstr("cameras.front_left.fx_px: found no such key, wanted a number, more than 0 "
                        "(line 7 has an unknown key fx_mm)"));
  EXPECT_THAT(error_after("    cx_px", "    cx_px: 1\n    cx_px"), HasSubstr("a second time"));
  EXPECT_THAT(error_after("  back_left:", "  rear_left:"),
              HasSubstr("cameras.back_left: found no such key"));
  EXPECT_THAT(error_after("cameras:", "units: mm\ncameras:"), HasSubstr("units: found an unknown"));
  EXPECT_THAT(error_after("cameras:", "Cameras:"), HasSubstr("cameras: found no such key"));
}

TEST(RigYaml, TheDemoRigIsTheSimulatedRig) {
  const auto rig = read_rig(std::filesystem::path(BEVLOC_SOURCE_DIR) / "config/rig_demo.yaml");
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  EXPECT_EQ(format_rig(*rig), format_rig(sim::nominal_rig()));
}

TEST(RigYaml, KeepsFisheyesAndTheOwnBody) {
  Rig rig = any_rig();
  Intrinsics& fisheye = rig.cameras[4].intrinsics;
  fisheye = {.lens = Lens::kFisheye,
             .width_px = 1280,
             .height_px = 800,
             .fx_px = 407.0,
             .fy_px = 407.0,
             .cx_px = 639.5,
             .cy_px = 399.5,
             .k1 = -0.02,
             .k2 = 0.003,
             .k3 = 1e-4,
             .k4 = -1e-5};
  rig.cameras[4].own_body_px = {{0.0, 799.0}, {640.0, 700.5}, {1279.0, 799.0}};
  const auto again = parse_rig(format_rig(rig), "rig.yaml");
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->cameras[4].intrinsics, fisheye);
  EXPECT_EQ(again->cameras[4].own_body_px, rig.cameras[4].own_body_px);
  EXPECT_TRUE(again->cameras[0].own_body_px.empty());
}

TEST(RigYaml, RefusesABodyWithoutThreeCornersAndAnUnknownLens) {
  EXPECT_THAT(error_after("    fx_px: 500\n", "    fx_px: 500\n    own_body_px: [0, 1, 2, 3]\n"),
              HasSubstr("own_body_px: found 4 numbers, wanted column and row of at least three"));
  EXPECT_THAT(error_after("    fx_px: 500\n", "    fx_px: 500\n    lens: omni\n"),
              HasSubstr("lens: found omni, wanted"));
}

TEST(RigYaml, TheRigsBesideTheDemosAreRead) {
  for (const char* name : {"van", "fisheye", "nuscenes"}) {
    const auto file = std::filesystem::path(BEVLOC_SOURCE_DIR) / "config" /
                      (std::string("rig_") + name + ".yaml");
    const auto rig = read_rig(file);
    EXPECT_TRUE(rig.has_value()) << rig.error().message;
  }
}

TEST(RigYaml, NamesAMissingFile) {
  const auto rig = read_rig("/nonexistent/rig.yaml");
  ASSERT_FALSE(rig.has_value());
  EXPECT_THAT(rig.error().message, StartsWith("/nonexistent/rig.yaml: "));
}

}  // namespace
}  // namespace bevloc
