// Which framesets of recorded drives become samples, and in which part they are.
#include "training/drives/drive_set.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/capabilities.h"
#include "tests/training/picture_drive.h"

namespace bevloc::drives {
namespace {

namespace fs = std::filesystem;
using test::demo_rig;
using test::PictureDrive;
using testing::HasSubstr;

TEST(DriveSet, TakesAFramesetEveryMetreAndHoldsSquaresBack) {
  const PictureDrive drive(1000);  // 1,000 m in ten squares
  const auto set = drive.open();
  ASSERT_TRUE(set) << set.error().message;
  const auto& held_back = set->places(DrivePart::kHeldBack);
  const auto& calibration = set->places(DrivePart::kCalibration);
  const auto& training = set->places(DrivePart::kTraining);
  EXPECT_NEAR(static_cast<double>(held_back.size()), 100, 1) << "the fourth square";
  EXPECT_NEAR(static_cast<double>(calibration.size()), 100, 1) << "the seventh square";
  EXPECT_NEAR(static_cast<double>(set->left_out().beside_other_part), 4 * 36, 4);
  EXPECT_EQ(held_back.size() + calibration.size() + training.size() +
                set->left_out().beside_other_part + set->left_out().too_close +
                set->left_out().without_pose,
            1000U);
  const auto x_of = [](const SamplePlace& place) { return static_cast<double>(place.frameset); };
  for (const auto* others : {&held_back, &calibration}) {
    for (const SamplePlace& one : *others) {
      for (const SamplePlace& other : training) {
        ASSERT_GE(std::abs(x_of(one) - x_of(other)), 35.0);
      }
    }
  }
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

/// Poses 1 m apart at the times of the framesets.
std::vector<ReferenceTrajectory::Pose> line_east(double x_m, double y_m, int framesets) {
  std::vector<ReferenceTrajectory::Pose> poses;
  for (int i = -1; i < framesets + 3; ++i) {
    poses.push_back(
        {PictureDrive::kStart + i * std::chrono::milliseconds(100), Se2{x_m + i, y_m, 0.0}});
  }
  return poses;
}

TEST(DriveSet, ASampleShowsNoSquareOfALaterPart) {
  for (const double heading_rad : {0.0, std::atan2(15.0, 30.0), radians(45.0), radians(-63.0)}) {
    PictureDrive drive(2000);
    drive.write_reference(0.0, 200.0, heading_rad);
    auto set = drive.open();
    ASSERT_TRUE(set) << set.error().message;
    for (const auto& [name, part] : kDriveParts) {
      ASSERT_FALSE(set->places(part).empty()) << name << ", heading " << degrees(heading_rad);
      for (const SamplePlace& place : set->places(part)) {
        const DriveIndex& index = set->drive(place.drive).index();
        const Se2 pose = index.reference.at(index.framesets[place.frameset].time).value();
        for (const Eigen::Vector2d& corner : corners_of_rasters(pose)) {
          ASSERT_LE(part_of(square_at(corner)), part)
              << "heading " << degrees(heading_rad) << ", frameset " << place.frameset;
        }
      }
    }
  }
}

TEST(DriveSet, LeavesOutCalibrationBesideAPlaceThatIsHeldBack) {
  ASSERT_EQ(part_of({26, 2}), DrivePart::kHeldBack);
  ASSERT_EQ(part_of({27, 2}), DrivePart::kCalibration);
  PictureDrive drive(400);
  drive.write_reference(line_east(2500.0, 250.0, 400));  // through four squares
  const auto set = drive.open();
  ASSERT_TRUE(set) << set.error().message;
  EXPECT_NEAR(static_cast<double>(set->places(DrivePart::kHeldBack).size()), 100, 1);
  // Of the samples for calibration, those at least 36 m away count.
  EXPECT_NEAR(static_cast<double>(set->places(DrivePart::kCalibration).size()), 64, 2);
}

/// The framesets of one drive that are samples of a part.
std::vector<size_t> framesets_in(const DriveSet& set, DrivePart part, size_t drive) {
  std::vector<size_t> framesets;
  for (const SamplePlace& place : set.places(part)) {
    if (place.drive == drive) framesets.push_back(place.frameset);
  }
  return framesets;
}

TEST(DriveSet, APlaceKeepsItsPartWhenOtherDrivesComeOrGo) {
  PictureDrive first(500);
  first.write_reference(line_east(0.0, 5050.0, 500));
  const PictureDrive second(1000);
  const test::TemporaryFolder folder;
  fs::create_directory_symlink(first.folder(), folder / "a");
  fs::create_directory_symlink(second.folder(), folder / "b");
  const auto both = DriveSet::open(
      {.folder = folder.path(), .reference = ReferenceKind::kFile, .rig = demo_rig()});
  ASSERT_TRUE(both) << both.error().message;
  ASSERT_EQ(both->drives(), 2U);
  const auto alone = second.open();
  ASSERT_TRUE(alone) << alone.error().message;
  for (const auto& [name, part] : kDriveParts) {
    EXPECT_FALSE(alone->places(part).empty()) << name;
    EXPECT_EQ(framesets_in(*both, part, 1), framesets_in(*alone, part, 0)) << name;
  }
}

TEST(DriveSet, StatesTheRangesOfItsCameras) {
  const PictureDrive drive(10);
  Rig rig = demo_rig();
  rig.cameras[1].intrinsics.fx_px = 1000.0;  // of 640 columns
  rig.cameras[4].vehicle_from_camera.translation_m.z() = 3.1;
  const auto set = drive.open(rig);
  ASSERT_TRUE(set) << set.error().message;
  const CameraRanges ranges = set->camera_ranges();
  EXPECT_DOUBLE_EQ(ranges.most_focal_px, 500.0);
  EXPECT_DOUBLE_EQ(ranges.least_focal_px, 0.5 * rig.cameras[4].intrinsics.fx_px);
  EXPECT_DOUBLE_EQ(ranges.most_height_m, 3.1);
  EXPECT_DOUBLE_EQ(ranges.least_height_m, rig.cameras[2].vehicle_from_camera.translation_m.z());
}

TEST(DriveSet, NamesAFolderThatCannotBeFollowed) {
  const test::TemporaryFolder folder;
  fs::create_directory_symlink("circle", folder / "circle");
  const auto set = DriveSet::open({.folder = folder.path(), .reference = ReferenceKind::kFile});
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().message, HasSubstr("circle: found no file or folder behind this name"));
}

TEST(DriveSet, NamesAFolderThatCannotBeRead) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "closed");
  fs::permissions(folder / "closed", fs::perms::none);
  test::without_capabilities([&folder] {
    const auto set = DriveSet::open({.folder = folder.path(), .reference = ReferenceKind::kFile});
    ASSERT_FALSE(set);
    EXPECT_THAT(set.error().message, HasSubstr("closed: found no way to list this folder"));
  });
  fs::permissions(folder / "closed", fs::perms::owner_all);  // so that it can be removed
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

}  // namespace
}  // namespace bevloc::drives
