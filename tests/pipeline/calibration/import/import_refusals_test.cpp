// Tests what the import refuses or must not confuse, and the file and line that its messages name.
#include <gmock/gmock.h>

#include "tests/pipeline/calibration/import/import_fixture.h"

namespace bevloc {
namespace {

using namespace test;

const std::string kNose = replaced(kCameraInfo, "camera_name: front", "camera_name: nose");

RigImportOptions with_nose_as_front() {
  RigImportOptions options = with_base();
  options.our_names = {{"nose", "front"}};
  return options;
}

TEST(ImportRefusals, ANameOfTheFilesIsNotOneOfOurs) {
  // The chain's own "front" is our front_left, and our front is a camera of another file.
  const Rig base = demo_rig();
  const Se3 vehicle_from_left = base.cameras[0].vehicle_from_camera;
  const Se3 vehicle_from_back_left = base.cameras[3].vehicle_from_camera;
  const std::string chain = kalibr_chain({}, vehicle_from_back_left.inverse() * vehicle_from_left);
  RigImportOptions options = with_nose_as_front();
  options.our_names["front"] = "front_left";
  options.our_names["side"] = "back_left";
  options.vehicle_from = {{"front", base.cameras[1].vehicle_from_camera},
                          {"front_left", vehicle_from_left}};
  const auto imported = import_rig({{"camchain.yaml", chain}, {"nose.yaml", kNose}}, options);
  ASSERT_TRUE(imported) << imported.error().message;
  const Se3& found = imported->rig.cameras[3].vehicle_from_camera;
  EXPECT_TRUE(found.rotation.isApprox(vehicle_from_back_left.rotation, 1e-6));
  EXPECT_TRUE(found.translation_m.isApprox(vehicle_from_back_left.translation_m, 1e-6));
}

TEST(ImportRefusals, ATopicMayBeCalledAsAFrame) {
  const Rig base = demo_rig();
  const std::string chain =
      replaced(kalibr_chain({}, base.cameras[2].vehicle_from_camera.inverse() *
                                    base.cameras[1].vehicle_from_camera),
               "/front/image_raw", "/vehicle/front/image_raw");
  RigImportOptions options = with_base();
  options.our_names = {{"vehicle", "front"}, {"side", "front_right"}};
  options.vehicle_from = {{"front", base.cameras[1].vehicle_from_camera}};
  const auto imported = import_rig({{"camchain.yaml", chain}}, options);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_TRUE(imported->rig.cameras[2].vehicle_from_camera.translation_m.isApprox(
      base.cameras[2].vehicle_from_camera.translation_m, 1e-6));
}

TEST(ImportRefusals, NoCameraOfOurs) {
  expect_refused({{"nose.yaml", kNose}}, with_base(),
                 "nose.yaml:1: found only cameras that have none of bevloc's names: nose, wanted "
                 "--map-camera THEIRS=OURS, such as nose=front");
  expect_refused({{"sparse/cameras.txt", "# none\n"}}, with_base(),
                 "sparse/cameras.txt: found no camera, wanted at least one");
}

TEST(ImportRefusals, PlacesThatNothingNeeds) {
  RigImportOptions options = with_nose_as_front();
  options.vehicle_from = {{"back", options.base->cameras[4].vehicle_from_camera}};
  expect_refused({{"nose.yaml", kNose}}, options,
                 "--extrinsics: found back, which is no imported camera, wanted places of");
  options.vehicle_from = {{"imu", Se3{}}};
  expect_refused({{"nose.yaml", kNose}}, options, "--extrinsics: found imu, wanted places that");
  const auto places = parse_extrinsics(
      "imu: {translation_m: [1, 2, 3], rotation_wxyz: [1, 0, 0, 0],\n x: 3}\n", "places.yaml");
  ASSERT_FALSE(places);
  EXPECT_EQ(places.error().message,
            "places.yaml:2: imu.x: found an unknown key, wanted translation_m and rotation_wxyz "
            "only");
}

TEST(ImportRefusals, ACameraThatIsNamedTwice) {
  const auto names = parse_camera_names({"cam0=front", "cam1=back"});
  ASSERT_TRUE(names);
  EXPECT_EQ(names->at("cam1"), "back");
  const auto twice = parse_camera_names({"cam0=front", "cam0=back"});
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().message,
            "--map-camera: found cam0=back after cam0=front, wanted each camera once");
  const auto wrong = parse_camera_names({"cam0"});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, testing::HasSubstr("found cam0, wanted THEIRS=OURS"));
}

TEST(ImportRefusals, RepeatedKeysFilesAndDocuments) {
  expect_refused({{"a.yaml", kNose + "image_width: 640\n"}}, with_nose_as_front(),
                 "a.yaml:17: found image_width again, wanted each key once");
  expect_refused({{"a.yaml", replaced(kNose, "cols: 3", "rows: 3")}}, with_nose_as_front(),
                 "a.yaml:6: camera_matrix: found rows again, wanted each key once");
  expect_refused({{"a.yaml", kNose + "---\n" + kCameraInfo}}, with_nose_as_front(),
                 "a.yaml:18: found a second document, wanted one in each file");
  EXPECT_TRUE(import_rig({{"a.yaml", kNose + "---\n"}}, with_nose_as_front()));
  expect_refused({{"a/cameras.txt", ""}, {"b/cameras.txt", ""}}, with_base(),
                 "b/cameras.txt: found a second file of its kind, wanted one");
}

TEST(ImportRefusals, BinningAndRegionsOfRos) {
  const auto refused = [](const std::string& added, const std::string& part) {
    expect_refused({{"a.yaml", kNose + added}}, with_nose_as_front(), part);
  };
  refused("binning_x: 2\n", "a.yaml:17: binning_x: found 2, wanted 0 or 1, because the camera");
  refused("binning_x: 1\nbinning_y: 3\n", "a.yaml:18: binning_y: found 3, wanted 0 or 1");
  refused("roi: {x_offset: 100, y_offset: 0}\n", "a.yaml:17: roi.x_offset: found 100, wanted 0");
  refused("roi: {width: 100, height: 720}\n", "roi.width: found 100, wanted 0 or the size of");
  const std::string whole =
      "binning_x: 0\nbinning_y: 1\nroi: {x_offset: 0, y_offset: 0, height: 720, width: 0}\n";
  EXPECT_TRUE(import_rig({{"a.yaml", kNose + whole}}, with_nose_as_front()));
}

TEST(ImportRefusals, TheSourceOfAnImpossibleValueIsNamed) {
  expect_refused({{"a.yaml", replaced(kNose, "[900.5", "[-900.5")}}, with_nose_as_front(),
                 "a.yaml:1: front.fx_px: found -900.5");
  expect_refused({{"a.yaml", replaced(kNose, "640.25", "9000")}}, with_nose_as_front(),
                 "a.yaml:1: front.cx_px: found a principal point at 9000, wanted -640 to 1920");
  RigImportOptions options = with_nose_as_front();
  options.vehicle_from["front"] = options.base->cameras[1].vehicle_from_camera;
  options.vehicle_from["front"].translation_m.z() = 9.0;
  expect_refused({{"a.yaml", kNose}}, options,
                 "--extrinsics: front.vehicle_from_camera.translation_m: found a camera 9 m above");
}

TEST(ImportRefusals, ATransformToACameraThatIsNotInTheChain) {
  const std::string chain = kalibr_chain({}, {});
  RigImportOptions options = with_base();
  options.our_names = {{"side", "front_left"}};
  options.vehicle_from = {{"front", options.base->cameras[1].vehicle_from_camera}};
  expect_refused({{"a.yaml", replaced(chain, "cam1:", "cam2:")}}, options,
                 "cam2.T_cn_cnm1: found no cam1 in the file, wanted the camera to which this");
}

TEST(ImportRefusals, TheOrderOfAChainInTheFileDoesNotMatter) {
  const Rig base = demo_rig();
  const std::string chain = kalibr_chain(
      {}, base.cameras[2].vehicle_from_camera.inverse() * base.cameras[1].vehicle_from_camera);
  const size_t second = chain.find("cam1:");
  RigImportOptions options = with_base();
  options.our_names = {{"side", "front_right"}};
  options.vehicle_from = {{"front", base.cameras[1].vehicle_from_camera}};
  const auto imported =
      import_rig({{"a.yaml", chain.substr(second) + chain.substr(0, second)}}, options);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_TRUE(imported->rig.cameras[2].vehicle_from_camera.translation_m.isApprox(
      base.cameras[2].vehicle_from_camera.translation_m, 1e-6));
}

TEST(ImportRefusals, ImagesOfColmapWithoutTheirLinesOfPoints) {
  const ForeignFile cameras{"cameras.txt",
                            "1 PINHOLE 640 360 500 500 320 180\n2 PINHOLE 640 360 -7 7 320 180\n"};
  const std::string front = "1 1 0 0 0 0 0 0 1 front/1.jpg\n";
  const std::string back = "2 1 0 0 0 0 0 0 2 back/1.jpg\n";
  expect_refused({cameras, {"images.txt", front + back}}, with_base(),
                 "images.txt:2: found 10 words, wanted the points of the image in the line before");
  expect_refused({cameras, {"images.txt", front + "7.5 8.5 -1\n" + back}}, with_base(),
                 "cameras.txt:2: back.fx_px: found -7");
}

TEST(ImportRefusals, OptionsThatNothingNeeds) {
  RigImportOptions options = with_nose_as_front();
  options.image_size_px = {640, 360};
  expect_refused({{"a.yaml", kNose}}, options, "--image-size: found files that all state the size");
  options = with_nose_as_front();
  options.tokens = {"abc"};
  expect_refused({{"a.yaml", kNose}}, options, "--token: found abc, wanted it only with files of");
  options.tokens = {};
  options.image_size_px = {640, 360};
  expect_refused({{"a.yaml", replaced(kNose, "image_width: 1280\n", "")}}, options,
                 "found no image_width");
}

TEST(ImportRefusals, AByteOrderMarkIsNoMistake) {
  const auto imported = import_rig({{"a.yaml", "\xEF\xBB\xBF" + kNose}}, with_nose_as_front());
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(imported->rig.cameras[1].intrinsics.fx_px, 900.5);
}

TEST(ImportRefusals, FurtherCoefficientsMayBeZero) {
  const std::string more = replaced(kNose, "cols: 5\n  data: [-0.12, 0.03, 0.001, -0.002, 0]",
                                    "cols: 14\n  data: [-0.12, 0.03, 0.001, -0.002, 0, 0, 0, 0, "
                                    "0, 0, 0, 0, 0, 0]");
  const auto imported = import_rig({{"a.yaml", more}}, with_nose_as_front());
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(imported->rig.cameras[1].intrinsics.p2, -0.002);
  expect_refused({{"a.yaml", replaced(more, "0, 0]", "0.5, 0]")}}, with_nose_as_front(),
                 "found taux = 0.5, wanted taux = 0");
}

}  // namespace
}  // namespace bevloc
