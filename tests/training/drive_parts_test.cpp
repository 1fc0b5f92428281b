// Which part of the training samples a place belongs to.
#include "training/drives/drive_parts.h"

#include <array>

#include <gtest/gtest.h>

namespace bevloc::drives {
namespace {

TEST(DriveParts, AnEighthIsHeldBackAndAnEighthIsForCalibration) {
  std::array<int, kDriveParts.size()> squares{};
  for (int64_t east = -100; east < 100; ++east) {
    for (int64_t north = -100; north < 100; ++north) {
      ++squares.at(static_cast<size_t>(part_of({east, north})));
    }
  }
  constexpr int kEighth = 200 * 200 / 8;
  EXPECT_NEAR(squares.at(static_cast<size_t>(DrivePart::kCalibration)), kEighth, kEighth / 20);
  EXPECT_NEAR(squares.at(static_cast<size_t>(DrivePart::kHeldBack)), kEighth, kEighth / 20);
}

TEST(DriveParts, StayAsTheyWereWhenNetworksWereTrained) {
  EXPECT_EQ(part_of({0, 0}), DrivePart::kTraining);
  EXPECT_EQ(part_of({3, 0}), DrivePart::kHeldBack);
  EXPECT_EQ(part_of({6, 0}), DrivePart::kCalibration);
  EXPECT_EQ(part_of({-1, -1}), DrivePart::kHeldBack);
  EXPECT_EQ(part_of({1000, -1000}), DrivePart::kTraining);
}

TEST(DriveParts, ASquareBeginsAtItsSouthWestCorner) {
  const Square square = square_at({300.0, -0.5});
  EXPECT_EQ(square.east, 3);
  EXPECT_EQ(square.north, -1);
}

TEST(DriveParts, NothingIsLearnedBesideASquareOfALaterPartThatNoDriveNeedsToVisit) {
  ASSERT_EQ(part_of({2, 0}), DrivePart::kTraining);
  ASSERT_EQ(part_of({3, 0}), DrivePart::kHeldBack);
  EXPECT_EQ(part_at({263.0, 50.0}), DrivePart::kTraining);
  EXPECT_EQ(part_at({265.0, 50.0}), std::nullopt);
  EXPECT_EQ(part_at({301.0, 50.0}), DrivePart::kHeldBack);
}

}  // namespace
}  // namespace bevloc::drives
