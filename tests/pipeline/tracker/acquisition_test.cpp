#include "pipeline/tracker/acquisition.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

Time at_ms(int milliseconds) {
  return Time{} + std::chrono::milliseconds(milliseconds);
}

TEST(AcquisitionTest, TrustsSeveralThatAgree) {
  Acquisition acquisition({.needed = 3});
  EXPECT_FALSE(acquisition.add(at_ms(0), {1.0, 0.5, 0.01}));
  EXPECT_FALSE(acquisition.add(at_ms(100), {1.1, 0.4, 0.012}));
  EXPECT_TRUE(acquisition.add(at_ms(200), {0.9, 0.5, 0.009}));
  EXPECT_TRUE(acquisition.add(at_ms(300), {1.0, 0.5, 0.01})) << "and stays so";
}

TEST(AcquisitionTest, StartsAgainAfterOneThatDisagrees) {
  const Se2 odd[] = {{-1.0, 0.5, 0.01}, {1.0, -0.5, 0.01}, {1.0, 0.5, -0.03}};
  for (const Se2& correction : odd) {
    Acquisition acquisition({.needed = 3});
    acquisition.add(at_ms(0), {1.0, 0.5, 0.01});
    acquisition.add(at_ms(100), {1.0, 0.5, 0.01});
    EXPECT_FALSE(acquisition.add(at_ms(200), correction));
    EXPECT_FALSE(acquisition.add(at_ms(300), correction));
    EXPECT_TRUE(acquisition.add(at_ms(400), correction));
  }
}

TEST(AcquisitionTest, ComparesAllWithAll) {
  Acquisition acquisition({.needed = 3, .position_tolerance_m = 0.4});
  acquisition.add(at_ms(0), {0.0, 0.0, 0.0});
  acquisition.add(at_ms(100), {0.3, 0.0, 0.0});
  EXPECT_FALSE(acquisition.add(at_ms(200), {0.6, 0.0, 0.0})) << "creeps away from the first";
  EXPECT_TRUE(acquisition.add(at_ms(300), {0.5, 0.0, 0.0})) << "agrees with the last two";
}

TEST(AcquisitionTest, ForgetsAfterAGapAndOnReset) {
  Acquisition acquisition({.needed = 2, .max_gap_s = 0.5});
  EXPECT_FALSE(acquisition.add(at_ms(0), {}));
  EXPECT_FALSE(acquisition.add(at_ms(600), {}));
  EXPECT_TRUE(acquisition.add(at_ms(700), {}));
  acquisition.reset();
  EXPECT_FALSE(acquisition.add(at_ms(800), {}));
  EXPECT_FALSE(acquisition.add(at_ms(750), {})) << "time went back";
}

}  // namespace
}  // namespace bevloc
