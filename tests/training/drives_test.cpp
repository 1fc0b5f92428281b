// Samples of recorded drives: which framesets are chosen, what is held back, and what a sample
// contains.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/files.h"
#include "common/image_file.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_index.h"
#include "tests/support/temporary_folder.h"
#include "training/drives/drive_sample.h"
#include "training/drives/drive_set.h"
#include "training/drives/own_track.h"

namespace bevloc::drives {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr Duration kSecond = std::chrono::seconds(1);

Rig demo_rig() {
  const auto rig = read_rig(std::string(BEVLOC_SOURCE_DIR) + "/config/rig_demo.yaml");
  EXPECT_TRUE(rig) << rig.error().message;
  return *rig;
}

/// A straight line to the east on both sides of the drive.
HdMap map_along(double length_m) {
  HdMap map;
  for (const double y_m : {-2.0, 2.0}) {
    map.elements.push_back(
        {.element_class = ElementClass::kLaneDivider, .points = {{-100.0, y_m}, {length_m, y_m}}});
  }
  return map;
}

/// A drive to the east at 10 m/s with a picture of each camera every 0.1 s, of which only the
/// indexes are real unless `with_pictures`.
class PictureDrive {
 public:
  explicit PictureDrive(int framesets, bool with_pictures = false) {
    const Rig rig = demo_rig();
    for (int camera = 0; camera < kCameraCount; ++camera) {
      const fs::path directory = folder_ / std::string(kCameraNames[camera]);
      fs::create_directories(directory);
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

  void write_reference(double from_s, double to_s, double heading_rad = 0.0) {
    const Eigen::Vector2d velocity(10.0 * std::cos(heading_rad), 10.0 * std::sin(heading_rad));
    std::vector<ReferenceTrajectory::Pose> poses;
    for (double time_s = from_s - 0.1; time_s <= to_s + 0.2; time_s += 0.1) {
      const Eigen::Vector2d place = time_s * velocity;
      poses.push_back({kStart + from_seconds(time_s), {place.x(), place.y(), heading_rad}});
    }
    EXPECT_TRUE(write_file(folder_ / kReferenceFile, ReferenceTrajectory(poses).to_csv()));
  }

  /// Camera c exposes 5 ms after camera c - 1.
  static Time time_of(int frameset, int camera) {
    return kStart + frameset * std::chrono::milliseconds(100) +
           camera * std::chrono::milliseconds(5);
  }
  const fs::path& folder() const { return folder_.path(); }
  Result<DriveSet> open() const {
    return DriveSet::open(
        {.folder = folder(), .reference = ReferenceKind::kFile, .rig = demo_rig()});
  }

  static constexpr Time kStart{100 * kSecond};

 private:
  test::TemporaryFolder folder_;
};

TEST(Framesets, JoinFramesOfTheSameMoment) {
  std::array<std::vector<Time>, kCameraCount> times;
  const auto at = [](int ms) { return Time(std::chrono::milliseconds(ms)); };
  times[0] = {at(0), at(100), at(200)};
  times[1] = {at(30), at(151)};
  const auto framesets = framesets_of(times);
  ASSERT_EQ(framesets.size(), 3U);
  EXPECT_EQ(framesets[0].present.count(), 2U);
  EXPECT_EQ(framesets[1].present.to_ulong(), 1U);
  EXPECT_EQ(framesets[2].present.count(), 2U) << "49 ms apart";
  EXPECT_EQ(framesets[2].time, at(151));
  EXPECT_EQ(framesets[2].frame[0], 2U);
  EXPECT_EQ(framesets[2].frame[1], 1U);
}

TEST(DriveSet, TakesAFramesetEveryMetreAndHoldsSquaresBack) {
  const PictureDrive drive(1000);  // 1,000 m in ten squares
  const auto set = drive.open();
  ASSERT_TRUE(set) << set.error().message;
  const auto& held_back = set->places(DrivePart::kHeldBack);
  const auto& training = set->places(DrivePart::kTraining);
  EXPECT_NEAR(static_cast<double>(held_back.size()), 200, 2) << "the fourth and the eighth square";
  EXPECT_NEAR(static_cast<double>(set->left_out().beside_held_back), 4 * 36, 4);
  EXPECT_EQ(held_back.size() + training.size() + set->left_out().beside_held_back +
                set->left_out().too_close + set->left_out().without_pose,
            1000U);
  const auto x_of = [](const SamplePlace& place) { return static_cast<double>(place.frameset); };
  for (const SamplePlace& one : held_back) {
    for (const SamplePlace& other : training) {
      ASSERT_GE(std::abs(x_of(one) - x_of(other)), 35.0);
    }
  }
}

std::pair<double, double> square_of(const Eigen::Vector2d& place) {
  return {std::floor(place.x() / DriveSet::kSquare_m), std::floor(place.y() / DriveSet::kSquare_m)};
}

/// The corners of the rasters of a sample, with the priors that are furthest off.
std::vector<Eigen::Vector2d> corners_of_rasters(const Se2& truth) {
  std::vector<Eigen::Vector2d> corners;
  for (const double right : {-1.0, 1.0}) {
    for (const double back : {-1.0, 1.0}) {
      const Se2 correction{2.0 * back, 1.0 * right, radians(2.0)};
      for (const Se2& pose : {truth, truth * correction.inverse()}) {
        for (const double x_m : {-30.0, 30.0}) {
          for (const double y_m : {-15.0, 15.0})
            corners.push_back(pose * Eigen::Vector2d(x_m, y_m));
        }
      }
    }
  }
  return corners;
}

TEST(DriveSet, ATrainingSampleShowsNoSquareThatIsHeldBack) {
  for (const double heading_rad : {0.0, std::atan2(15.0, 30.0), radians(45.0), radians(-63.0)}) {
    PictureDrive drive(1000);
    drive.write_reference(0.0, 100.0, heading_rad);
    auto set = drive.open();
    ASSERT_TRUE(set) << set.error().message;
    const auto pose_of = [&set](const SamplePlace& place) {
      const DriveIndex& index = set->drive(place.drive).index();
      return index.reference.at(index.framesets[place.frameset].time).value();
    };
    std::set<std::pair<double, double>> held_back;
    for (const SamplePlace& place : set->places(DrivePart::kHeldBack)) {
      held_back.insert(square_of(pose_of(place).translation()));
    }
    ASSERT_FALSE(held_back.empty());
    for (const SamplePlace& place : set->places(DrivePart::kTraining)) {
      for (const Eigen::Vector2d& corner : corners_of_rasters(pose_of(place))) {
        ASSERT_FALSE(held_back.contains(square_of(corner)))
            << "heading " << degrees(heading_rad) << ", frameset " << place.frameset;
      }
    }
  }
}

TEST(DriveSet, NamesAFolderThatCannotBeFollowed) {
  const test::TemporaryFolder folder;
  fs::create_directory_symlink("circle", folder / "circle");
  const auto set = DriveSet::open({.folder = folder.path(), .reference = ReferenceKind::kFile});
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("circle: found no file or folder behind this name"));
}

TEST(DriveSet, NamesAFolderThatCannotBeRead) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "closed");
  fs::permissions(folder / "closed", fs::perms::none);
  const auto set = DriveSet::open({.folder = folder.path(), .reference = ReferenceKind::kFile});
  fs::permissions(folder / "closed", fs::perms::owner_all);  // so that it can be removed
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("closed: found no way to list this folder"));
}

TEST(DriveSet, LeavesOutWhatHasNoReference) {
  PictureDrive drive(500);
  drive.write_reference(20.0, 40.0);
  const auto set = drive.open();
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_NEAR(static_cast<double>(set->left_out().without_pose), 300, 4);
}

TEST(DriveSet, RefusesAFolderWithoutDrives) {
  const test::TemporaryFolder folder;
  const auto set = DriveSet::open({.folder = folder.path(), .reference = ReferenceKind::kFile});
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("found no drive, wanted MCAP files"));
  const auto missing = DriveSet::open({.folder = "/nowhere", .reference = ReferenceKind::kFile});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("/nowhere: found no folder"));
}

TEST(DriveSet, RefusesPicturesWithoutARig) {
  const PictureDrive drive(10);
  const auto set = DriveSet::open({.folder = drive.folder(), .reference = ReferenceKind::kFile});
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("give --rig"));
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
