// Calibrations of other programs: conventions, compared with OpenCV's own projections, and
// refusals.
#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "tests/pipeline/calibration/import/import_fixture.h"

namespace bevloc {
namespace {

using namespace test;

constexpr int kFront = 1;

/// Focal lengths and centre as OpenCV counts them.
struct CameraMatrix {
  double fx_px, fy_px, cx_px, cy_px;
};

/// A row of opencv_projections.csv.
struct OpenCvProjection {
  double fisheye;
  std::array<double, 4> distortion;
  Eigen::Vector3d point;
  Eigen::Vector2d projected;
};

std::vector<OpenCvProjection> opencv_projections() {
  std::ifstream file(BEVLOC_SOURCE_DIR "/tests/pipeline/calibration/import/opencv_projections.csv");
  std::vector<OpenCvProjection> rows;
  for (std::string line; std::getline(file, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream values(line);
    OpenCvProjection row;
    values >> row.fisheye;
    for (double& coefficient : row.distortion) values >> coefficient;
    for (double& coordinate : row.point) values >> coordinate;
    for (double& coordinate : row.projected) values >> coordinate;
    if (values) rows.push_back(row);
  }
  return rows;
}

/// Compares the projections of a grid of rays with those of OpenCV, which are stored for each
/// distortion.
void expect_projects_as(const Intrinsics& lens, const CameraMatrix& matrix,
                        const std::array<double, 4>& distortion, bool fisheye = false,
                        double shift_px = 0.0) {
  int compared = 0;
  for (const OpenCvProjection& row : opencv_projections()) {
    if (row.distortion != distortion || (row.fisheye != 0.0) != fisheye) continue;
    const auto pixel = lens.project(row.point);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), matrix.fx_px * row.projected.x() + matrix.cx_px + shift_px, 1e-9);
    EXPECT_NEAR(pixel->y(), matrix.fy_px * row.projected.y() + matrix.cy_px + shift_px, 1e-9);
    ++compared;
  }
  EXPECT_EQ(compared, 25);
}

TEST(ImportRig, CameraInfoOfRosProjectsAsOpenCv) {
  const auto imported = import_rig({{"front.yaml", kCameraInfo}}, with_base());
  ASSERT_TRUE(imported) << imported.error().message;
  const CameraModel& front = imported->rig.cameras[kFront];
  EXPECT_EQ(front.intrinsics.width_px, 1280);
  expect_projects_as(front.intrinsics, {900.5, 901.5, 640.25, 361.75},
                     {-0.12, 0.03, 0.001, -0.002});
  // What the file lacks comes from the base.
  const Rig base = demo_rig();
  EXPECT_TRUE(front.vehicle_from_camera.rotation.isApprox(
      base.cameras[kFront].vehicle_from_camera.rotation, 1e-6));
  EXPECT_EQ(imported->rig.cameras[4].intrinsics, base.cameras[4].intrinsics);
}

TEST(ImportRig, CameraInfoWithAFisheye) {
  const std::string text = replaced(replaced(kCameraInfo, "plumb_bob", "equidistant"),
                                    "cols: 5\n  data: [-0.12, 0.03, 0.001, -0.002, 0]",
                                    "cols: 4\n  data: [-0.02, 0.003, 0.0004, -0.0001]");
  const auto imported = import_rig({{"front.yaml", text}}, with_base());
  ASSERT_TRUE(imported) << imported.error().message;
  expect_projects_as(imported->rig.cameras[kFront].intrinsics, {900.5, 901.5, 640.25, 361.75},
                     {-0.02, 0.003, 0.0004, -0.0001}, true);
}

TEST(ImportRig, ADistortionThatBevlocLacksIsRefusedByNameAndLine) {
  expect_refused({{"a.yaml", replaced(kCameraInfo, "-0.002, 0]", "-0.002, 0.01]")}}, with_base(),
                 "a.yaml:12: distortion_coefficients.data: found k3 = 0.01, wanted k3 = 0");
  expect_refused({{"a.yaml", replaced(kCameraInfo, "plumb_bob", "ftheta")}}, with_base(),
                 "a.yaml:8: distortion_model: found ftheta, wanted plumb_bob");
  expect_refused({{"a.yaml", replaced(kCameraInfo, "[900.5, 0,", "[900.5, 3,")}}, with_base(),
                 "skew");
  expect_refused({{"a.yaml", replaced(kCameraInfo, "[900.5", "[nine")}}, with_base(),
                 "a.yaml:7: camera_matrix.data[0]: found \"nine\", wanted a number");
}

TEST(ImportRig, WithoutAPlaceItSaysHowToGiveOne) {
  expect_refused({{"front.yaml", kCameraInfo}}, {}, "--base RIG");
  RigImportOptions named;
  named.our_names = {{"front", "nose"}};
  expect_refused({{"front.yaml", kCameraInfo}}, named, "--map-camera: found nose");
}

TEST(ImportRig, FileStorageOfOpenCv) {
  const std::string text = R"(%YAML:1.0
---
image_width: 800
image_height: 600
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.0e+02, 0., 3.995e+02, 0., 5.1e+02, 2.995e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 4
   cols: 1
   dt: d
   data: [ -1.0e-01, 1.0e-02, 1.0e-03, 2.0e-03 ]
)";
  RigImportOptions options = with_base();
  options.our_names = {{"left_camera", "front_left"}};
  const auto imported = import_rig({{"calib/left_camera.yml", text}}, options);
  ASSERT_TRUE(imported) << imported.error().message;
  expect_projects_as(imported->rig.cameras[0].intrinsics, {500, 510, 399.5, 299.5},
                     {-0.1, 0.01, 0.001, 0.002});
  expect_refused({{"calib/left_camera.yml", text.substr(0, text.find("distortion"))}}, options,
                 "no distortion_coefficients");
  expect_refused({{"b.yml", replaced(text, "rows: 4", "rows: 3")}}, options, "b.yml:14");

  const std::string doubt = "pinhole, but if it is a fisheye of OpenCV, add `fisheye_model: 1`";
  EXPECT_NE(imported->notes[0].find(doubt), std::string::npos) << imported->notes[0];
  const auto sure = import_rig({{"calib/left_camera.yml", text + "fisheye_model: 0\n"}}, options);
  ASSERT_TRUE(sure) << sure.error().message;
  EXPECT_EQ(sure->notes[0].find(doubt), std::string::npos) << sure->notes[0];
}

TEST(ImportRig, TheOwnBodyComesFromTheBase) {
  RigImportOptions options = with_base();
  CameraModel& base = options.base->cameras[kFront];
  base.own_body_px = {{0, 700}, {1279, 700}, {640, 719}};
  base.intrinsics.width_px = 1280;
  base.intrinsics.height_px = 720;
  const auto same_size = import_rig({{"front.yaml", kCameraInfo}}, options);
  ASSERT_TRUE(same_size) << same_size.error().message;
  EXPECT_EQ(same_size->rig.cameras[kFront].own_body_px, base.own_body_px);

  base.intrinsics.height_px = 800;
  const auto other_size = import_rig({{"front.yaml", kCameraInfo}}, options);
  ASSERT_TRUE(other_size) << other_size.error().message;
  EXPECT_TRUE(other_size->rig.cameras[kFront].own_body_px.empty());
  EXPECT_NE(other_size->notes[kFront].find("measure it again"), std::string::npos);
}

TEST(ImportRig, TheChainOfKalibrEndsAtTheVehicle) {
  const Rig base = demo_rig();
  const Se3 vehicle_from_front = base.cameras[1].vehicle_from_camera;
  const Se3 vehicle_from_right = base.cameras[2].vehicle_from_camera;
  const Se3 vehicle_from_imu{
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(),
      {0.8, 0.1, 0.6}};
  const std::string chain = kalibr_chain(vehicle_from_front.inverse() * vehicle_from_imu,
                                         vehicle_from_right.inverse() * vehicle_from_front);
  RigImportOptions options = with_base();
  options.our_names = {{"side", "front_right"}};
  options.vehicle_from = {{"imu", vehicle_from_imu}};
  const auto imported = import_rig({{"camchain.yaml", chain}}, options);
  ASSERT_TRUE(imported) << imported.error().message;
  for (const int camera : {1, 2}) {
    const Se3& found = imported->rig.cameras[camera].vehicle_from_camera;
    const Se3& wanted = base.cameras[camera].vehicle_from_camera;
    EXPECT_TRUE(found.rotation.isApprox(wanted.rotation, 1e-6)) << camera;
    EXPECT_TRUE(found.translation_m.isApprox(wanted.translation_m, 1e-6)) << camera;
  }
  expect_projects_as(imported->rig.cameras[1].intrinsics, {510, 511, 330, 180},
                     {-0.1, 0.01, 0.001, 0.002});
  expect_projects_as(imported->rig.cameras[2].intrinsics, {400, 400, 320, 180},
                     {0.01, 0.02, 0.0, 0.0}, true);

  // One camera's place is enough for the other, in either direction.
  options.vehicle_from = {{"front_right", vehicle_from_right}};
  const auto anchored = import_rig({{"camchain.yaml", chain}}, options);
  ASSERT_TRUE(anchored) << anchored.error().message;
  EXPECT_TRUE(anchored->rig.cameras[1].vehicle_from_camera.translation_m.isApprox(
      vehicle_from_front.translation_m, 1e-6));

  RigImportOptions bare;
  bare.our_names = {{"side", "back"}};
  expect_refused({{"camchain.yaml", chain}}, bare, "front_left: found no such camera");
  expect_refused({{"c.yaml", replaced(chain, "camera_model: pinhole", "camera_model: omni")}},
                 options, "c.yaml:8: cam0.camera_model: found omni, wanted pinhole");
  expect_refused({{"c.yaml", replaced(chain, "[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.0, 2.0]")}},
                 options, "wanted a rigid transform");
}

TEST(ImportRig, AChainMayStateTheInverseAndBeginAsAFileOfOpenCv) {
  // OpenVINS writes such chains.
  const Rig base = demo_rig();
  const Se3 vehicle_from_front = base.cameras[1].vehicle_from_camera;
  const Se3 right_from_front = base.cameras[2].vehicle_from_camera.inverse() * vehicle_from_front;
  const Se3 vehicle_from_imu{Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                             {0.8, 0.1, 0.6}};
  const Se3 front_from_imu = vehicle_from_front.inverse() * vehicle_from_imu;
  const std::string chain = kalibr_chain(front_from_imu, right_from_front);
  const std::string inverse =
      replaced(kalibr_chain(front_from_imu.inverse(), right_from_front), "T_cam_imu", "T_imu_cam");
  RigImportOptions options = with_base();
  options.our_names = {{"side", "front_right"}};
  options.vehicle_from = {{"imu", vehicle_from_imu}};
  for (const std::string& text : {chain, inverse}) {
    for (const std::string head : {"", "%YAML:1.0\n", "%YAML:1.0\n---\n"}) {
      const auto imported = import_rig({{"chain.yaml", head + text}}, options);
      ASSERT_TRUE(imported) << head << imported.error().message;
      for (const int camera : {1, 2}) {
        const Se3& found = imported->rig.cameras[camera].vehicle_from_camera;
        const Se3& wanted = base.cameras[camera].vehicle_from_camera;
        EXPECT_TRUE(found.rotation.isApprox(wanted.rotation, 1e-6)) << head << camera;
        EXPECT_TRUE(found.translation_m.isApprox(wanted.translation_m, 1e-6)) << head << camera;
      }
      EXPECT_EQ(imported->rig.cameras[1].intrinsics.fx_px, 510.0);
    }
  }
}

const std::string kSensors = R"([
{"token": "s1", "channel": "CAM_FRONT", "modality": "camera"},
{"token": "s2", "channel": "LIDAR_TOP", "modality": "lidar"}
])";
const std::string kCalibrated = R"([
{"token": "c1", "sensor_token": "s1", "translation": [1.70079, 0.01594, 1.51095],
 "rotation": [0.4998015, -0.5030317, 0.4997798, -0.4973747],
 "camera_intrinsic": [[1266.4, 0.0, 816.3], [0.0, 1266.4, 491.5], [0.0, 0.0, 1.0]]},
{"token": "c2", "sensor_token": "s2", "translation": [0.9, 0.0, 1.8],
 "rotation": [0.7, 0.0, 0.0, -0.7], "camera_intrinsic": []}
])";

TEST(ImportRig, NuScenesHasThePoseOfTheCameraOnTheVehicle) {
  RigImportOptions options = with_base();
  options.our_names = {{"CAM_FRONT", "front"}};
  const std::vector<ForeignFile> files = {{"calibrated_sensor.json", kCalibrated},
                                          {"sensor.json", kSensors}};
  expect_refused(files, options, "wanted --image-size");
  options.image_size_px = {1600, 900};
  const auto imported = import_rig(files, options);
  ASSERT_TRUE(imported) << imported.error().message;
  const CameraModel& front = imported->rig.cameras[1];
  EXPECT_NEAR(front.vehicle_from_camera.translation_m.x(), 1.70079, 1e-6);
  // It looks ahead, with its x axis to the right.
  EXPECT_GT(front.vehicle_from_camera.rotation(0, 2), 0.99);
  EXPECT_LT(front.vehicle_from_camera.rotation(1, 0), -0.99);
  expect_projects_as(front.intrinsics, {1266.4, 1266.4, 816.3, 491.5}, {});
  expect_refused({files[0]}, options, "wanted sensor.json too");

  const std::string second = kCalibrated.substr(kCalibrated.find("{\"token\": \"c1\""),
                                                kCalibrated.find(",\n{\"token\": \"c2\"") - 2);
  const std::string two =
      "[" + second + ",\n" + replaced(replaced(second, "c1", "c3"), "1.70079", "1.6") + "]";
  expect_refused({{"calibrated_sensor.json", two}, files[1]}, options, "--token c3");
  options.tokens = {"c3", "zz"};
  expect_refused({{"calibrated_sensor.json", two}, files[1]}, options,
                 "--token: found zz, wanted the token of a camera in calibrated_sensor.json");
  options.tokens = {"c3"};
  const auto chosen = import_rig({{"calibrated_sensor.json", two}, files[1]}, options);
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_NEAR(chosen->rig.cameras[1].vehicle_from_camera.translation_m.x(), 1.6, 1e-6);
}

ForeignFile colmap_camera(const std::string& line) {
  return {"sparse/cameras.txt", "# Camera list\n3 " + line + "\n"};
}

TEST(ImportRig, ColmapCountsPixelsFromTheCornerAndMapsIntoTheCamera) {
  const Rig base = demo_rig();
  const auto image_of = [](const CameraModel& camera, const std::string& name) {
    const Se3 camera_from_world = camera.vehicle_from_camera.inverse();
    const Eigen::Quaterniond q(camera_from_world.rotation);
    const Eigen::Vector3d& t = camera_from_world.translation_m;
    return fmt::format("1 {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} 3 {}.png\n\n", q.w(),
                       q.x(), q.y(), q.z(), t.x(), t.y(), t.z(), name);
  };
  const std::string images = "# Image list\n" + image_of(base.cameras[1], "front");
  RigImportOptions options = with_base();
  options.vehicle_from = {{"world", Se3{}}};
  const auto imported =
      import_rig({colmap_camera("OPENCV 640 360 510 512 320.5 180.5 -0.1 0.02 0.001 -0.002"),
                  {"sparse/images.txt", images}},
                 options);
  ASSERT_TRUE(imported) << imported.error().message;
  const CameraModel& front = imported->rig.cameras[1];
  expect_projects_as(front.intrinsics, {510, 512, 320.5, 180.5}, {-0.1, 0.02, 0.001, -0.002}, false,
                     -0.5);
  EXPECT_TRUE(front.vehicle_from_camera.translation_m.isApprox(
      base.cameras[1].vehicle_from_camera.translation_m, 1e-6));

  // One camera's place is enough for the other. Empty lines may stand between images.
  const std::string side = image_of(base.cameras[2], "side");
  options.vehicle_from = {{"front", base.cameras[1].vehicle_from_camera}};
  options.our_names = {{"side", "front_right"}};
  const auto both = import_rig(
      {colmap_camera("PINHOLE 640 360 510 512 320.5 180.5"), {"images.txt", images + "\n" + side}},
      options);
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_TRUE(both->rig.cameras[2].vehicle_from_camera.translation_m.isApprox(
      base.cameras[2].vehicle_from_camera.translation_m, 1e-6));
}

TEST(ImportRig, TheLensModelsOfColmapBecomeOurs) {
  RigImportOptions options = with_base();
  options.our_names = {{"3", "front"}};
  const struct {
    const char* line;
    std::array<double, 4> distortion;
    bool fisheye;
  } kModels[] = {{"SIMPLE_PINHOLE 640 360 500 320 180", {}, false},
                 {"PINHOLE 640 360 500 500 320 180", {}, false},
                 {"SIMPLE_RADIAL 640 360 500 320 180 -0.1", {-0.1, 0, 0, 0}, false},
                 {"RADIAL 640 360 500 320 180 -0.1 0.02", {-0.1, 0.02, 0, 0}, false},
                 {"FULL_OPENCV 640 360 500 500 320 180 -0.1 0.02 0.001 0.002 0 0 0 0",
                  {-0.1, 0.02, 0.001, 0.002},
                  false},
                 {"OPENCV_FISHEYE 640 360 500 500 320 180 0.01 0.02 0.003 0.004",
                  {0.01, 0.02, 0.003, 0.004},
                  true}};
  for (const auto& model : kModels) {
    const auto read = import_rig({colmap_camera(model.line)}, options);
    ASSERT_TRUE(read) << model.line << ": " << read.error().message;
    expect_projects_as(read->rig.cameras[1].intrinsics, {500, 500, 320, 180}, model.distortion,
                       model.fisheye, -0.5);
  }
  expect_refused({colmap_camera("FOV 640 360 500 500 320 180 0.9")}, options,
                 "sparse/cameras.txt:2: found FOV");
  expect_refused({colmap_camera("FULL_OPENCV 640 360 500 500 320 180 0 0 0 0 0.1 0 0 0")}, options,
                 "found k3 = 0.1");
  expect_refused({colmap_camera("PINHOLE 640 360 500 500 320")}, options,
                 "found 3 parameters, wanted 4");
}

TEST(ImportRig, UnknownFilesAreRefused) {
  expect_refused({{"a.yaml", "key: value\n"}}, {}, "a.yaml: found no known calibration");
  expect_refused({{"a.yaml", "key: [1, 2\n"}}, {}, "a.yaml:2:");
  expect_refused({{"a.json", "[]"}}, {}, "a.json: found no known calibration");
}

TEST(ParseExtrinsics, ReadsPlacesByName) {
  const auto places = parse_extrinsics(
      "imu: {translation_m: [1, 2, 3], rotation_wxyz: [1, 0, 0, 0]}\n", "places.yaml");
  ASSERT_TRUE(places) << places.error().message;
  EXPECT_EQ(places->at("imu").translation_m, Eigen::Vector3d(1, 2, 3));
  const auto wrong = parse_extrinsics(
      "\nimu: {translation_m: [1, 2, 3], rotation_wxyz: [2, 0, 0, 0]}\n", "places.yaml");
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("places.yaml:2: imu.rotation_wxyz: found a quaternion"),
            std::string::npos)
      << wrong.error().message;
}

}  // namespace
}  // namespace bevloc
