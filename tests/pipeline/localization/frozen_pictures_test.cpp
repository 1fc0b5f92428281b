#include "pipeline/localization/frozen_pictures.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "pipeline/preprocessing/image_remap.h"

namespace bevloc {
namespace {

constexpr int kCamera = 3;

std::vector<int8_t> picture() {
  std::vector<int8_t> planes(kNetworkImageSize);
  for (size_t i = 0; i < planes.size(); ++i) planes[i] = static_cast<int8_t>(i * i / 100);
  return planes;
}

class FrozenPicturesTest : public testing::Test {
 protected:
  /// As often as a frozen picture needs; the first showing of it repeats nothing.
  bool show(const std::vector<int8_t>& planes, bool driving, int times) {
    bool is_frozen = false;
    for (int i = 0; i < times; ++i) is_frozen = pictures_.is_frozen(kCamera, planes, driving);
    return is_frozen;
  }

  FrozenPictures pictures_;
  std::vector<int8_t> planes_ = picture();
};

TEST_F(FrozenPicturesTest, NoticesAPictureAfterSoManyRepetitionsWhileDriving) {
  EXPECT_FALSE(show(planes_, true, FrozenPictures::kRepetitions));
  EXPECT_TRUE(show(planes_, true, 1));
  EXPECT_TRUE(show(planes_, true, 5));
}

TEST_F(FrozenPicturesTest, JudgesNothingWhileTheVehicleStands) {
  EXPECT_FALSE(show(planes_, false, 100));
  EXPECT_FALSE(show(planes_, true, FrozenPictures::kRepetitions - 1));
  EXPECT_FALSE(show(planes_, false, 100));
  EXPECT_TRUE(show(planes_, true, 1));
}

TEST_F(FrozenPicturesTest, APictureStaysFrozenWhileTheVehicleStands) {
  EXPECT_TRUE(show(planes_, true, 1 + FrozenPictures::kRepetitions));
  EXPECT_TRUE(show(planes_, false, 3));
}

TEST_F(FrozenPicturesTest, OneOtherValueAnywhereIsAnotherPicture) {
  for (const size_t place : {size_t{0}, size_t{63}, size_t{4711}, kNetworkImageSize - 1}) {
    EXPECT_TRUE(show(planes_, true, 1 + FrozenPictures::kRepetitions));
    ++planes_[place];
    EXPECT_FALSE(show(planes_, true, FrozenPictures::kRepetitions)) << place;
    EXPECT_TRUE(show(planes_, true, 1)) << place;
  }
}

TEST_F(FrozenPicturesTest, PicturesThatChangePlacesAreOthers) {
  std::vector<int8_t> swapped = planes_;
  std::swap_ranges(swapped.begin(), swapped.begin() + 64, swapped.begin() + 64);
  ASSERT_NE(swapped, planes_);
  EXPECT_NE(picture_checksum(swapped), picture_checksum(planes_));
}

TEST_F(FrozenPicturesTest, EachCameraHasItsOwnHistory) {
  for (int i = 0; i < 3 * FrozenPictures::kRepetitions; ++i) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      ++planes_[0];
      EXPECT_FALSE(pictures_.is_frozen(camera, planes_, true));
    }
  }
}

/// What a camera shows in a tunnel without light, or with a cap on its lens, is of no use either.
TEST_F(FrozenPicturesTest, AUniformPictureIsLikeAnyOther) {
  const std::vector<int8_t> black(kNetworkImageSize, kNetworkBlack);
  EXPECT_FALSE(show(black, true, FrozenPictures::kRepetitions));
  EXPECT_TRUE(show(black, true, 1));
}

}  // namespace
}  // namespace bevloc
