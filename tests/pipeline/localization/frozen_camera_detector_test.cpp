#include "pipeline/localization/frozen_camera_detector.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/preprocessing/image_remap.h"

namespace bevloc {
namespace {

constexpr int kCamera = 3;

std::vector<int8_t> image() {
  std::vector<int8_t> planes(kNetworkImageSize);
  for (size_t i = 0; i < planes.size(); ++i) planes[i] = static_cast<int8_t>(i * i / 100);
  return planes;
}

class FrozenCameraDetectorTest : public testing::Test {
 protected:
  /// Adds the image `times` times. The first time is no repetition.
  bool show(const std::vector<int8_t>& planes, bool driving, int times) {
    bool is_frozen = false;
    for (int i = 0; i < times; ++i) is_frozen = detector_.is_frozen(kCamera, planes, driving);
    return is_frozen;
  }

  FrozenCameraDetector detector_;
  std::vector<int8_t> planes_ = image();
};

TEST_F(FrozenCameraDetectorTest, DetectsAFrozenCameraAfterRepetitionsWhileDriving) {
  EXPECT_FALSE(show(planes_, true, FrozenCameraDetector::kRepetitions));
  EXPECT_TRUE(show(planes_, true, 1));
  EXPECT_TRUE(show(planes_, true, 5));
}

TEST_F(FrozenCameraDetectorTest, CountsNoRepetitionsWhileTheVehicleStands) {
  EXPECT_FALSE(show(planes_, false, 100));
  EXPECT_FALSE(show(planes_, true, FrozenCameraDetector::kRepetitions - 1));
  EXPECT_FALSE(show(planes_, false, 100));
  EXPECT_TRUE(show(planes_, true, 1));
}

TEST_F(FrozenCameraDetectorTest, ACameraStaysFrozenWhileTheVehicleStands) {
  EXPECT_TRUE(show(planes_, true, 1 + FrozenCameraDetector::kRepetitions));
  EXPECT_TRUE(show(planes_, false, 3));
}

TEST_F(FrozenCameraDetectorTest, AChangeOfAnyValueResetsTheCount) {
  for (const size_t place : {size_t{0}, size_t{63}, size_t{4711}, kNetworkImageSize - 1}) {
    EXPECT_TRUE(show(planes_, true, 1 + FrozenCameraDetector::kRepetitions));
    ++planes_[place];
    EXPECT_FALSE(show(planes_, true, FrozenCameraDetector::kRepetitions)) << place;
    EXPECT_TRUE(show(planes_, true, 1)) << place;
  }
}

TEST_F(FrozenCameraDetectorTest, DetectsALoopOfImages) {
  for (const int length : {2, 4, 64, 500}) {
    FrozenCameraDetector detector;
    const auto shows = [&](int number) {
      std::vector<int8_t> planes = image();
      planes[0] = static_cast<int8_t>(number % 100);
      planes[1] = static_cast<int8_t>(number / 100);
      return detector.is_frozen(kCamera, planes, true);
    };
    for (int i = 0; i < length; ++i) EXPECT_FALSE(shows(i)) << length;
    for (int i = 0; i < FrozenCameraDetector::kRepetitions - 1; ++i)
      EXPECT_FALSE(shows(i % length));
    for (int i = FrozenCameraDetector::kRepetitions - 1; i < 3 * length; ++i) {
      EXPECT_TRUE(shows(i % length)) << length << ", image " << i;
    }
    EXPECT_FALSE(shows(length + 1)) << "a new image ends the loop";
  }
}

TEST_F(FrozenCameraDetectorTest, RemembersTheLatestImagesOfALongDrive) {
  std::vector<int8_t> planes = image();
  const auto show_number = [&](int number) {
    planes[0] = static_cast<int8_t>(number % 100);
    planes[1] = static_cast<int8_t>(number / 100);
    return detector_.is_frozen(kCamera, planes, true);
  };
  constexpr int kImages = 3 * FrozenCameraDetector::kRemembered;
  for (int i = 0; i < kImages; ++i) ASSERT_FALSE(show_number(i)) << i;
  const int oldest = kImages - FrozenCameraDetector::kRemembered;
  for (int i = oldest; i < oldest + FrozenCameraDetector::kRepetitions - 1; ++i) {
    EXPECT_FALSE(show_number(i));
  }
  EXPECT_TRUE(show_number(oldest + FrozenCameraDetector::kRepetitions));
}

TEST_F(FrozenCameraDetectorTest, TheChecksumDependsOnTheOrderOfTheValues) {
  std::vector<int8_t> swapped = planes_;
  std::swap_ranges(swapped.begin(), swapped.begin() + 64, swapped.begin() + 64);
  ASSERT_NE(swapped, planes_);
  EXPECT_NE(image_checksum(swapped), image_checksum(planes_));
}

TEST_F(FrozenCameraDetectorTest, EachCameraHasItsOwnHistory) {
  for (int i = 0; i < 3 * FrozenCameraDetector::kRepetitions; ++i) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      ++planes_[0];
      EXPECT_FALSE(detector_.is_frozen(camera, planes_, true));
    }
  }
}

/// The image of a covered lens is uniform.
TEST_F(FrozenCameraDetectorTest, AUniformImageCanFreezeToo) {
  const std::vector<int8_t> black(kNetworkImageSize, kNetworkBlack);
  EXPECT_FALSE(show(black, true, FrozenCameraDetector::kRepetitions));
  EXPECT_TRUE(show(black, true, 1));
}

}  // namespace
}  // namespace bevloc
