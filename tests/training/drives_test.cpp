// What a sample of a recorded drive contains, and the track of what the appliance sent itself.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/map/map_index.h"
#include "tests/training/picture_drive.h"
#include "training/drives/drive_sample.h"
#include "training/drives/own_track.h"

namespace bevloc::drives {
namespace {

namespace fs = std::filesystem;
using test::demo_rig;
using test::PictureDrive;
using testing::HasSubstr;

/// A straight line on both sides of the drive.
HdMap map_along(double length_m) {
  HdMap map;
  for (const double y_m : {PictureDrive::kNorth_m - 2.0, PictureDrive::kNorth_m + 2.0}) {
    map.elements.push_back(
        {.element_class = ElementClass::kLaneDivider, .points = {{-100.0, y_m}, {length_m, y_m}}});
  }
  return map;
}

class DriveSampleTest : public testing::Test {
 protected:
  Status make(const SampleChoice& choice) {
    DriveSampleMaker maker(*set_, index_);
    return maker.make(set_->places(DrivePart::kTraining)[5], choice, sample_);
  }

  PictureDrive drive_{400, true};
  Result<DriveSet> set_ = drive_.open();
  const HdMap map_ = map_along(500.0);
  const MapIndex index_{map_};
  SampleChoice choice_{{1.2, -0.6, 0.02}, CameraMask(0b111111)};
  DriveSample sample_;
};

TEST_F(DriveSampleTest, HasTheImagesOfItsCameras) {
  choice_.cameras = CameraMask(0b101111);
  ASSERT_TRUE(make(choice_));
  for (size_t camera = 0; camera < kCameraCount; ++camera) {
    // The middle of the first colour plane.
    const size_t middle = camera * kNetworkImageSize + static_cast<size_t>(kNetworkPixels) / 2;
    EXPECT_EQ(sample_.images[middle], camera == 4 ? 0 : 40 + camera);
  }
  EXPECT_EQ(sample_.cameras, choice_.cameras);
}

TEST(DriveSample, KeepsTheCamerasOfAFramesetThatHasNoneOfTheWantedOnes) {
  const PictureDrive drive(20, true);
  for (const std::string_view camera : kCameraNames) {
    if (camera != "back") fs::remove_all(drive.folder() / camera);
  }
  auto set = drive.open();
  ASSERT_TRUE(set) << set.error().message;
  const HdMap map = map_along(500.0);
  const MapIndex index(map);
  DriveSampleMaker maker(*set, index);
  DriveSample sample;
  const SampleChoice choice{{1.2, -0.6, 0.02}, CameraMask(0b101111)};
  const Status made = maker.make(set->places(DrivePart::kTraining).front(), choice, sample);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(sample.cameras, CameraMask(0b010000));
}

TEST_F(DriveSampleTest, PutsThePriorBesideTheReferenceByTheCorrection) {
  ASSERT_TRUE(make(choice_));
  EXPECT_DOUBLE_EQ(sample_.correction.x_m, 1.2);
  // The lines are 2 m to either side of the reference. The prior is 0.6 m further to the left at
  // this heading, so both lines are nearer to the right edge of its raster.
  const auto mean_col = [](const std::vector<uint8_t>& raster) {
    double sum = 0.0;
    double weight = 0.0;
    const int row = kRasterGrid.rows / 2;
    for (int col = 0; col < kRasterGrid.cols; ++col) {
      const double value = raster[static_cast<size_t>(row * kRasterGrid.cols + col)];
      sum += value * col;
      weight += value;
    }
    return sum / weight;
  };
  const double shift_cells = mean_col(sample_.raster_prior) - mean_col(sample_.raster_truth);
  EXPECT_NEAR(shift_cells * kRasterGrid.cell_m, 0.6, 0.05);
}

TEST_F(DriveSampleTest, MovesTheViewByTheTimeOfEachExposure) {
  ASSERT_TRUE(make(choice_));
  // At 10 m/s the last camera exposes 25 ms and 0.25 m after the first.
  CameraMotions motions{};
  for (int camera = 0; camera < kCameraCount; ++camera) motions[camera].x_m = 0.05 * camera;
  const ViewTable wanted =
      make_view_table(network_rig(demo_rig()), choice_.cameras, kFeatureGrid, motions);
  double largest = 0.0;
  for (size_t i = 0; i < wanted.weight.size(); ++i) {
    if (wanted.index[i] != sample_.table.index[i]) continue;
    largest = std::max(largest,
                       static_cast<double>(std::abs(wanted.weight[i] - sample_.table.weight[i])));
  }
  EXPECT_LT(largest, 0.01);
  const ViewTable without = make_view_table(network_rig(demo_rig()), choice_.cameras, kFeatureGrid);
  EXPECT_NE(without.weight, sample_.table.weight);
}

TEST_F(DriveSampleTest, NamesADamagedPicture) {
  ASSERT_TRUE(write_file(drive_.folder() / "back" / "0.png", "no picture"));
  const Status status = make(choice_);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("s after its first frameset"));
  EXPECT_THAT(status.error().message, HasSubstr("back/0.png"));
}

TEST_F(DriveSampleTest, RefusesAMapOfElsewhere) {
  HdMap elsewhere = map_along(10.0);
  for (MapElement& element : elsewhere.elements) {
    for (Eigen::Vector2d& point : element.points) point.y() += 1e4;
  }
  const MapIndex index(elsewhere);
  DriveSampleMaker maker(*set_, index);
  const Status status = maker.make(set_->places(DrivePart::kTraining)[5], choice_, sample_);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("is it the map of this drive?"));
}

TEST(RandomChoice, IsTheSameForTheSameSample) {
  const auto one = random_choice(7, 3, 0.5);
  const auto same = random_choice(7, 3, 0.5);
  EXPECT_EQ(one.correction.x_m, same.correction.x_m);
  EXPECT_EQ(one.cameras, same.cameras);
  int missing = 0;
  double largest_x_m = 0.0;
  for (uint64_t i = 0; i < 1000; ++i) {
    const auto choice = random_choice(7, i, 0.5);
    if (!choice.cameras.all()) ++missing;
    largest_x_m = std::max(largest_x_m, std::abs(choice.correction.x_m));
    EXPECT_GE(choice.cameras.count(), 4U);
  }
  EXPECT_NEAR(missing, 500, 60);
  EXPECT_GT(largest_x_m, 1.9);
  EXPECT_LE(largest_x_m, 2.0);
}

TEST(OwnTrack, SmoothingKeepsAParabolaAndRemovesNoise) {
  std::vector<ReferenceTrajectory::Pose> poses;
  const auto x_at = [](double time_s) { return 8.0 * time_s + 0.7 * time_s * time_s; };
  for (int i = 0; i < 400; ++i) {
    const double time_s = 0.01 * i;
    const double noise_m = i % 2 == 0 ? 0.1 : -0.1;
    poses.push_back({Time(from_seconds(time_s)), {x_at(time_s) + noise_m, noise_m, 3.14}});
  }
  const auto smooth = smoothed(poses);
  ASSERT_GT(smooth.size(), 50U);
  for (const auto& [time, pose] : smooth) {
    const double time_s = to_seconds(time.time_since_epoch());
    EXPECT_NEAR(pose.x_m, x_at(time_s), 0.01);
    EXPECT_NEAR(pose.y_m, 0.0, 0.01);
    EXPECT_NEAR(pose.yaw_rad, 3.14, 1e-6);
  }
}

}  // namespace
}  // namespace bevloc::drives
