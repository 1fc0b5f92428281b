#include "evaluation/calib/folder_recording.h"

#include <fstream>

#include <gtest/gtest.h>

#include "common/image_file.h"
#include "sim/sim_rig.h"
#include "tests/evaluation/calib/picture_folder.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

int framesets_at(int rate_hz, Duration interval) {
  const test::TemporaryFolder folder;
  test::write_picture_folder(folder.path(), rate_hz);
  const auto recording = FolderRecording::open(folder.path(), sim::nominal_rig(), interval);
  EXPECT_TRUE(recording) << recording.error().message;
  return recording ? (*recording)->framesets() : 0;
}

TEST(FolderRecording, AFramesetHasOneFrameOfEachCamera) {
  EXPECT_EQ(framesets_at(10, Duration::zero()), 10);
  EXPECT_EQ(framesets_at(30, Duration::zero()), 30);
  EXPECT_EQ(framesets_at(60, Duration::zero()), 60);
}

TEST(FolderRecording, KnowsWhichCamerasHavePictures) {
  const test::TemporaryFolder folder;
  test::write_picture_folder(folder.path(), 10);
  const auto recording = FolderRecording::open(folder.path(), sim::nominal_rig(), Duration::zero());
  ASSERT_TRUE(recording) << recording.error().message;
  for (size_t i = 0; i < kCameraCount; ++i) {
    const bool is_written = kCameraNames[i] == "front" || kCameraNames[i] == "back";
    EXPECT_EQ((*recording)->cameras()[i], is_written) << kCameraNames[i];
  }
}

TEST(FolderRecording, SkipsFramesetsWithinTheInterval) {
  EXPECT_EQ(framesets_at(30, std::chrono::milliseconds(450)), 3);
}

/// Sums over the pictures are rounded in this order.
TEST(FolderRecording, GivesThePicturesOfAFramesetInTheOrderOfTime) {
  const test::TemporaryFolder folder;
  test::write_picture_folder(folder.path(), 1);
  std::ofstream(folder.path() / "front" / "frames.txt") << "0 9000000 picture.png\n";
  const Rig rig = sim::nominal_rig();
  for (const int camera : {1, 4}) {
    const Intrinsics& lens = rig.cameras[camera].intrinsics;
    const RgbImage image(lens.width_px, lens.height_px);
    const auto file = folder.path() / kCameraNames[camera] / "picture.png";
    ASSERT_TRUE(write_png(image.view(), file.string()));
  }
  const auto recording = FolderRecording::open(folder.path(), rig, Duration::zero());
  ASSERT_TRUE(recording) << recording.error().message;
  std::vector<RecordedPicture> pictures;
  ASSERT_TRUE((*recording)->next(pictures));
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_EQ(kCameraNames[pictures[0].camera], "back");
  EXPECT_EQ(kCameraNames[pictures[1].camera], "front");
}

}  // namespace
}  // namespace bevloc::evaluation
