// Which names the cameras of other programs' files get, and what is said about those without one.
#include <gmock/gmock.h>

#include "tests/pipeline/calibration/import/import_fixture.h"

namespace bevloc {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

/// A camera_info of ROS. Its focal length tells which camera it is.
std::string camera_info(const std::string& name, int focal_px) {
  return replaced(replaced(kCameraInfo, "camera_name: front", "camera_name: " + name), "900.5",
                  std::to_string(focal_px));
}

/// The focal lengths of the cameras, in the order of kCameraNames.
std::vector<double> focal_lengths(const std::vector<ForeignFile>& files,
                                  const RigImportOptions& options) {
  const auto imported = import_rig(files, options);
  EXPECT_TRUE(imported) << imported.error().message;
  std::vector<double> result;
  if (!imported) return result;
  for (const CameraModel& camera : imported->rig.cameras) {
    result.push_back(camera.intrinsics.fx_px);
  }
  return result;
}

TEST(ImportNames, SixFilesWithTheDefaultNameOfRosAreNamedAfterTheirFiles) {
  std::vector<ForeignFile> files;
  int focal_px = 900;
  for (const std::string_view name : kCameraNames) {
    files.push_back({fmt::format("ros/{}.yaml", name), camera_info("narrow_stereo", ++focal_px)});
  }
  EXPECT_THAT(focal_lengths(files, with_base()), ElementsAre(901, 902, 903, 904, 905, 906));
}

TEST(ImportNames, TheFileNamesACameraWhoseOwnNameSaysNothing) {
  EXPECT_EQ(focal_lengths({{"back.yaml", camera_info("narrow_stereo", 950)}}, with_base())[4], 950);
  RigImportOptions mapped = with_base();
  mapped.our_names = {{"narrow_stereo", "front"}};
  EXPECT_EQ(focal_lengths({{"back.yaml", camera_info("narrow_stereo", 950)}}, mapped)[1], 950)
      << "--map-camera names it";
  EXPECT_EQ(focal_lengths({{"back.yaml", camera_info("front", 950)}}, with_base())[1], 950)
      << "its own name is one of ours";
}

TEST(ImportNames, FilesThatShareANameAreCalledByTheirStems) {
  const std::vector<ForeignFile> files = {{"a.yaml", camera_info("narrow_stereo", 950)},
                                          {"b.yaml", camera_info("narrow_stereo", 960)}};
  RigImportOptions options = with_base();
  options.our_names = {{"narrow_stereo", "front"}};
  expect_refused(files, options,
                 "--map-camera: found narrow_stereo, wanted one of the files' cameras: a, b");
  options.our_names = {{"a", "front"}, {"b", "back"}};
  const std::vector<double> focal_px = focal_lengths(files, options);
  EXPECT_EQ(focal_px.at(1), 950);
  EXPECT_EQ(focal_px.at(4), 960);
  expect_refused(
      {{"a/front.yaml", camera_info("x", 950)}, {"b/front.yaml", camera_info("x", 960)}},
      with_base(),
      "b/front.yaml:1: found a second camera front (first at a/front.yaml:1), wanted one "
      "of each name; leave one out, or give it another name in its file");
}

TEST(ImportNames, ImagesOfColmapBelowOneFolder) {
  const std::vector<ForeignFile> files = {
      {"cameras.txt", "1 PINHOLE 640 360 500 500 320 180\n2 PINHOLE 640 360 510 510 320 180\n"},
      {"images.txt",
       "1 1 0 0 0 0 0 0 1 pictures/front.jpg\n\n2 1 0 0 0 0 0 0 2 pictures/back.jpg\n\n"}};
  const std::vector<double> focal_px = focal_lengths(files, with_base());
  EXPECT_EQ(focal_px.at(1), 500);
  EXPECT_EQ(focal_px.at(4), 510);
}

TEST(ImportNames, ACameraOfKalibrWhoseKeyIsTheTopicOfAnother) {
  const auto chain = [](const std::string& second_topic) {
    return replaced(replaced(kalibr_chain({}, {}), "/front/image_raw", "/cam1/image_raw"),
                    "  rostopic: /side/image_raw\n", second_topic);
  };
  RigImportOptions options = with_base();
  options.our_names = {{"cam0", "front"}, {"cam1", "back"}};
  for (const char* topic : {"", "  rostopic: /cam1/right/image_raw\n"}) {
    const std::vector<double> focal_px = focal_lengths({{"k.yaml", chain(topic)}}, options);
    EXPECT_EQ(focal_px.at(1), 510) << topic;
    EXPECT_EQ(focal_px.at(4), 400) << topic;
  }
  // Topics that differ are the names, whatever the keys are.
  const std::string swapped = chain("  rostopic: /cam0/image_raw\n");
  EXPECT_EQ(focal_lengths({{"k.yaml", swapped}}, options).at(1), 400);
}

TEST(ImportNames, ACameraThatIsLeftOutIsNamed) {
  const auto imported = import_rig(
      {{"front.yaml", kCameraInfo}, {"front_rigth.yaml", camera_info("front_rigth", 950)}},
      with_base());
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_EQ(imported->notes.size(), kCameraCount + 1U);
  EXPECT_EQ(imported->notes.back(),
            "front_rigth.yaml:1: front_rigth is left out, because it has none of bevloc's names; "
            "--map-camera front_rigth=OURS gives it one");
}

}  // namespace
}  // namespace bevloc
