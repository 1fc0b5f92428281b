#include "evaluation/calib/folder_recording.h"

#include <fstream>

#include <gtest/gtest.h>

#include "common/files.h"
#include "sim/sim_rig.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

/// Writes a folder of one second in which front and back send `rate_hz` frames each, the back
/// camera 4 ms later.
void write_folder(const test::TemporaryFolder& folder, int rate_hz) {
  for (const auto& [camera, offset_ms] : {std::pair("front", 0), std::pair("back", 4)}) {
    const std::filesystem::path path = std::filesystem::path(folder.path()) / camera;
    std::filesystem::create_directory(path);
    std::ofstream(path / "picture.png");
    std::ofstream index(path / "frames.txt");
    for (int i = 0; i < rate_hz; ++i) {
      index << i << ' ' << 1'000'000'000LL * i / rate_hz + 1'000'000LL * offset_ms
            << " picture.png\n";
    }
  }
  std::ofstream(folder / "reference.csv") << "time_ns,x_m,y_m,yaw_deg\n0,0,0,0\n"
                                             "100000000,1,0,0\n2000000000,20,0,0\n";
}

int framesets_at(int rate_hz, Duration interval) {
  const test::TemporaryFolder folder;
  write_folder(folder, rate_hz);
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
  write_folder(folder, 10);
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

}  // namespace
}  // namespace bevloc::evaluation
