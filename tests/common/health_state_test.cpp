#include "common/health_state.h"

#include <algorithm>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

TEST(Why, EachReasonHasATextOfItsOwn) {
  std::set<std::string> texts;
  for (int bit = 0; bit < kWhyCount; ++bit) {
    const std::string text = to_string(WhyMask::from_bits(1u << bit));
    EXPECT_FALSE(text.empty()) << "bit " << bit;
    EXPECT_TRUE(texts.insert(text).second) << text;
  }
}

TEST(Why, AllReasonsTogetherAreListedInTheOrderOfTheirBits) {
  const std::string text = to_string(WhyMask::from_bits(UINT32_MAX));
  EXPECT_TRUE(text.starts_with("camera missing, cameras unsynchronized, "));
  EXPECT_TRUE(text.ends_with(", odometry implausible, foreign sender"));
  EXPECT_EQ(std::ranges::count(text, ','), kWhyCount - 1);
}

TEST(WhyMask, KeepsBitsAbove15) {
  const WhyMask mask = Why::kGnssContradicts | Why::kCameraMissing;
  EXPECT_TRUE(mask.has(Why::kGnssContradicts));
  EXPECT_FALSE(mask.has(Why::kClockGap));
  EXPECT_EQ(mask.bits(), 0x10001u);
  EXPECT_EQ(WhyMask::from_bits(mask.bits()), mask);
}

}  // namespace
}  // namespace bevloc
