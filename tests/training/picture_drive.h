// A drive in a folder of pictures for the tests of training's samples.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/image_file.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "tests/support/demo_rig.h"
#include "tests/support/temporary_folder.h"
#include "training/drives/drive_set.h"

namespace bevloc::test {

/// A drive to the east at 10 m/s with a picture of each camera every 0.1 s, of which only the
/// indexes are real unless `with_pictures`. It starts kNorth_m north of the map's origin, in the
/// middle of a row of squares (drive_parts.h). The fourth square is held back, the seventh is for
/// calibration.
class PictureDrive {
 public:
  explicit PictureDrive(int framesets, bool with_pictures = false) {
    const Rig rig = demo_rig();
    for (int camera = 0; camera < kCameraCount; ++camera) {
      const std::filesystem::path directory = folder_ / std::string(kCameraNames[camera]);
      std::filesystem::create_directories(directory);
      const Intrinsics& lens = rig.cameras[camera].intrinsics;
      RgbImage image(lens.width_px, lens.height_px);
      std::ranges::fill(image.pixels, static_cast<uint8_t>(40 + camera));
      EXPECT_TRUE(with_pictures ? write_png(image.view(), (directory / "0.png").string())
                                : write_file(directory / "0.png", "no picture"));
      std::ofstream index(directory / "frames.txt");
      for (int i = 0; i < framesets; ++i) {
        index << i << ' ' << time_of(i, camera).time_since_epoch().count() << " 0.png\n";
      }
    }
    write_reference(0.0, 0.1 * framesets);
  }

  void write_reference(const std::vector<ReferenceTrajectory::Pose>& poses) {
    EXPECT_TRUE(write_file(folder_ / kReferenceFile, ReferenceTrajectory(poses).to_csv()));
  }

  void write_reference(double from_s, double to_s, double heading_rad = 0.0) {
    const Eigen::Vector2d velocity(10.0 * std::cos(heading_rad), 10.0 * std::sin(heading_rad));
    std::vector<ReferenceTrajectory::Pose> poses;
    for (double time_s = from_s - 0.1; time_s <= to_s + 0.2; time_s += 0.1) {
      const Eigen::Vector2d place = time_s * velocity;
      poses.push_back(
          {kStart + from_seconds(time_s), {place.x(), kNorth_m + place.y(), heading_rad}});
    }
    write_reference(poses);
  }

  /// Camera c exposes 5 ms after camera c - 1.
  static Time time_of(int frameset, int camera) {
    return kStart + frameset * std::chrono::milliseconds(100) +
           camera * std::chrono::milliseconds(5);
  }
  const std::filesystem::path& folder() const { return folder_.path(); }
  Result<drives::DriveSet> open(const Rig& rig = demo_rig()) const {
    return drives::DriveSet::open(
        {.folder = folder(), .reference = drives::ReferenceKind::kFile, .rig = rig});
  }

  static constexpr Time kStart{std::chrono::seconds(100)};
  static constexpr double kNorth_m = 50.0;

 private:
  TemporaryFolder folder_;
};

}  // namespace bevloc::test
