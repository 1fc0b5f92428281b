// Which rigs are refused: each mistake that integrators make, in an otherwise good rig.
#include "pipeline/calibration/rig_check.h"

#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/calibration/rig_yaml.h"
#include "sim/sim_rig.h"
#include "tests/pipeline/calibration/folding_fisheye.h"

namespace bevloc {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

enum Camera : size_t { kFrontLeft, kFront, kFrontRight, kBackLeft, kBack, kBackRight };

/// "" for a good rig, otherwise what parse_rig() says.
std::string message_for(const Rig& rig) {
  const auto again = parse_rig(format_rig(rig), "rig.yaml");
  EXPECT_EQ(again.has_value(), !find_mistake(rig));
  return again ? "" : again.error().message;
}

/// A camera that looks to an azimuth, `down_deg` below the horizon, rolled about its axis.
Eigen::Matrix3d looking(double azimuth_deg, double down_deg, double roll_deg = 0.0) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  Eigen::Matrix3d level;  // looks along x
  level << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return (Eigen::AngleAxisd(azimuth_deg * kDegree, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(down_deg * kDegree, Eigen::Vector3d::UnitY()))
             .toRotationMatrix() *
         level * Eigen::AngleAxisd(roll_deg * kDegree, Eigen::Vector3d::UnitZ());
}

Rig rig_looking(std::array<double, kCameraCount> azimuths_deg, double down_deg) {
  Rig rig = sim::nominal_rig();
  for (int i = 0; i < kCameraCount; ++i) {
    rig.cameras[i].vehicle_from_camera.rotation = looking(azimuths_deg[i], down_deg);
  }
  return rig;
}

TEST(RigCheck, AcceptsTheDemoRigAndOthers) {
  EXPECT_EQ(message_for(sim::nominal_rig()), "");
  EXPECT_EQ(message_for(rig_looking({45, 0, -45, 135, 180, -135}, 25)), "");
  EXPECT_EQ(message_for(rig_looking({90, 2, -90, 160, -178, -160}, 45)), "");
  EXPECT_EQ(message_for(rig_looking({30, -5, -40, 80, 170, -95}, -10)), "");
}

/// The published calibration of a nuScenes vehicle, for undistorted images of 1600 x 900.
TEST(RigCheck, AcceptsANuscenesRig) {
  struct Entry {
    double focal_px, cx_px, cy_px;
    Eigen::Vector3d place_m;
    Eigen::Quaterniond rotation;
  };
  const std::array<Entry, kCameraCount> entries = {{
      {1272.6, 826.6, 479.8, {1.524, 0.495, 1.509}, {0.67573, -0.67363, 0.21214, -0.21123}},
      {1266.4, 816.3, 491.5, {1.701, 0.016, 1.511}, {0.49980, -0.50303, 0.49978, -0.49737}},
      {1260.8, 808.0, 495.3, {1.551, -0.493, 1.496}, {0.20603, -0.20269, 0.68245, -0.67136}},
      {1256.7, 792.1, 492.8, {1.036, 0.485, 1.591}, {0.69242, -0.70316, -0.11648, 0.11203}},
      {809.2, 829.2, 481.8, {0.028, 0.003, 1.579}, {0.50379, -0.49740, -0.49419, 0.50455}},
      {1259.5, 807.3, 501.2, {1.015, -0.481, 1.562}, {0.12281, -0.13240, -0.70043, 0.69050}},
  }};
  Rig rig;
  for (int i = 0; i < kCameraCount; ++i) {
    const Entry& entry = entries[i];
    rig.cameras[i].intrinsics = {.width_px = 1600,
                                 .height_px = 900,
                                 .fx_px = entry.focal_px,
                                 .fy_px = entry.focal_px,
                                 .cx_px = entry.cx_px,
                                 .cy_px = entry.cy_px};
    rig.cameras[i].vehicle_from_camera = {entry.rotation.normalized().toRotationMatrix(),
                                          entry.place_m};
  }
  EXPECT_EQ(message_for(rig), "");
}

TEST(RigCheck, RefusesEveryPairOfSwappedNames) {
  for (int a = 0; a < kCameraCount; ++a) {
    for (int b = 0; b < a; ++b) {
      Rig rig = sim::nominal_rig();
      std::swap(rig.cameras[a], rig.cameras[b]);
      EXPECT_THAT(message_for(rig), HasSubstr("rotation_wxyz: found")) << a << " " << b;
    }
  }
}

TEST(RigCheck, RefusesSixEqualCameras) {
  for (int kept = 0; kept < kCameraCount; ++kept) {
    Rig rig = sim::nominal_rig();
    rig.cameras.fill(rig.cameras[kept]);
    EXPECT_THAT(message_for(rig), HasSubstr("optical ax")) << kept;
  }
}

TEST(RigCheck, RefusesTwoCamerasThatLookTheSameWay) {
  Rig rig = rig_looking({40, 35, -56, 108, 180, -110}, 1);
  EXPECT_EQ(message_for(rig),
            "rig.yaml:14: cameras.front_left.vehicle_from_camera.rotation_wxyz: found optical axes "
            "40.0 degrees (front_left) and 35.0 degrees (front) to the left of forward, wanted "
            "front_left at least 10 degrees to the left of front");
}

TEST(RigCheck, RefusesConjugatedQuaternions) {
  Rig all = sim::nominal_rig();
  for (CameraModel& camera : all.cameras) {
    camera.vehicle_from_camera.rotation.transposeInPlace();
  }
  EXPECT_NE(message_for(all), "");
  for (int i = 0; i < kCameraCount; ++i) {
    Rig one = sim::nominal_rig();
    one.cameras[i].vehicle_from_camera.rotation.transposeInPlace();
    EXPECT_THAT(message_for(one), HasSubstr("rotation_wxyz: found")) << i;
  }
}

TEST(RigCheck, RefusesCamerasThatLookTheOtherWay) {
  for (int i = 0; i < kCameraCount; ++i) {
    Rig rig = sim::nominal_rig();
    Eigen::Matrix3d& rotation = rig.cameras[i].vehicle_from_camera.rotation;
    rotation = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()) * rotation;
    EXPECT_THAT(message_for(rig), HasSubstr("degrees for a camera named")) << i;
  }
}

TEST(RigCheck, RefusesImpossibleMountings) {
  Rig rig = sim::nominal_rig();
  Se3& front = rig.cameras[kFront].vehicle_from_camera;
  front.rotation = looking(0, 1, 179);
  EXPECT_THAT(message_for(rig), HasSubstr("found a camera rolled by -179.0 degrees"));
  front.rotation = looking(0, 1, 90);
  EXPECT_THAT(message_for(rig), HasSubstr("degrees about its optical axis, wanted a roll of at "
                                          "most 15 degrees"));
  front.rotation = looking(0, 90);
  EXPECT_THAT(message_for(rig), HasSubstr("found an optical axis -90.0 degrees above the horizon"));
  front.rotation = looking(0, -40);
  EXPECT_THAT(message_for(rig), HasSubstr("an optical axis 40.0 degrees above the horizon"));
  front.rotation = looking(0, 1);
  for (const double height_m : {-1.5, 0.0, 6.1}) {
    front.translation_m.z() = height_m;
    EXPECT_THAT(message_for(rig), HasSubstr("translation_m: found a camera"));
  }
}

TEST(RigCheck, RefusesImpossibleFocalLengths) {
  for (const double focal_px : {1e12, 4000.0, 20.0, 1e-9}) {
    Rig rig = sim::nominal_rig();
    rig.cameras[kBack].intrinsics.fx_px = focal_px;
    rig.cameras[kBack].intrinsics.fy_px = focal_px;
    EXPECT_THAT(message_for(rig), HasSubstr("cameras.back.fx_px: found a focal length of"));
  }
  Rig rig = sim::nominal_rig();
  rig.cameras[kBack].intrinsics.fy_px *= 2.1;
  EXPECT_THAT(message_for(rig), HasSubstr("fy_px: found 2.1 times fx_px, wanted 0.5 to 2"));
}

TEST(RigCheck, RefusesAPrincipalPointFarOutsideOfTheImage) {
  Rig rig = sim::nominal_rig();
  Intrinsics& back = rig.cameras[kBack].intrinsics;
  const Intrinsics good = back;
  for (const double share : {-8.0, -0.51, 1.51, 14.0}) {
    back = good;
    back.cx_px = share * back.width_px;
    EXPECT_THAT(message_for(rig), HasSubstr("cameras.back.cx_px: found a principal point at"));
    back = good;
    back.cy_px = share * back.height_px;
    EXPECT_THAT(message_for(rig), HasSubstr("cameras.back.cy_px: found a principal point at"));
  }
  back = good;
  back.cx_px = -0.1 * back.width_px;
  back.cy_px = 1.2 * back.height_px;
  EXPECT_EQ(message_for(rig), "") << "a part of a larger image";
}

TEST(RigCheck, RefusesADistortionThatFoldsAnywhere) {
  const auto refused = [](double k1, double k2, double p1, double p2) {
    Rig rig = sim::nominal_rig();
    Intrinsics& camera = rig.cameras[kFrontRight].intrinsics;
    camera.k1 = k1;
    camera.k2 = k2;
    camera.p1 = p1;
    camera.p2 = p2;
    return testing::Matches(HasSubstr("cameras.front_right.distortion: found a distortion"))(
        message_for(rig));
  };
  EXPECT_TRUE(refused(-2.5, 0, 0, 0));
  EXPECT_TRUE(refused(0, -3, 0, 0));
  EXPECT_TRUE(refused(0, 0, 0.8, 0));
  EXPECT_TRUE(refused(0, 0, 0, -0.8));
  EXPECT_FALSE(refused(-0.35, 0.12, 1e-3, -1e-3));
}

TEST(RigCheck, RefusesImagesThatCannotBeScaled) {
  const auto message = [](int width_px, int height_px) {
    Rig rig = sim::nominal_rig();
    Intrinsics& camera = rig.cameras[kBack].intrinsics;
    camera = resized(camera, width_px, height_px);
    return message_for(rig);
  };
  EXPECT_EQ(message(9920, 5580), "");
  EXPECT_EQ(message(640, 360), "");
  for (const auto& [width_px, height_px] :
       {std::pair(640, 1), {1920, 6}, {12000, 60}, {12000, 6750}, {8, 8}, {1920, 40}}) {
    EXPECT_THAT(message(width_px, height_px), HasSubstr("cameras.back.image_size_px"))
        << width_px << " x " << height_px;
  }
}

TEST(RigCheck, RefusesAFisheyeThatFoldsWithinTheImageOnly) {
  const auto message = [](double cx_px, double k3) {
    Rig rig = sim::nominal_rig();
    Intrinsics& camera = rig.cameras[kFront].intrinsics;
    camera = test::folding_fisheye();
    camera.cx_px = cx_px;
    camera.k3 = k3;
    return message_for(rig);
  };
  EXPECT_EQ(message(174.543, -0.04293), "");
  EXPECT_THAT(message(174.543, -0.1), HasSubstr("cameras.front.distortion"));
  EXPECT_THAT(message(-100.0, -0.04293), HasSubstr("cameras.front.distortion"));
}

}  // namespace
}  // namespace bevloc
