#include "sim/samples/passage.h"

#include <cmath>

#include <gtest/gtest.h>

namespace bevloc::sim {
namespace {

TEST(Passage, TheMotionFromOdometryHasASmallError) {
  double squares = 0.0;
  constexpr int kPassages = 500;
  for (uint64_t seed = 0; seed < kPassages; ++seed) {
    Passage passage({.spread_s = 0.05}, seed);
    const double offset_s = passage.next_offset_s();
    EXPECT_LE(std::abs(offset_s), 0.05);
    const Se2 truth = passage.true_motion(offset_s);
    const Se2 error = correction_between(truth, passage.known_motion(offset_s));
    EXPECT_LT(std::abs(error.x_m), 0.02 * std::abs(truth.x_m) + 1e-9);
    EXPECT_LT(std::abs(error.yaw_rad), radians(0.05));
    squares += error.x_m * error.x_m;
  }
  EXPECT_GT(squares, 0.0);
  EXPECT_LT(std::sqrt(squares / kPassages), 0.005);
}

TEST(Passage, TheKnownMotionIsZeroWithoutCompensation) {
  const Passage passage({.spread_s = 0.05, .compensated = false}, 1);
  EXPECT_GT(passage.true_motion(0.05).x_m, 0.2);
  EXPECT_EQ(passage.known_motion(0.05).x_m, 0.0);
}

}  // namespace
}  // namespace bevloc::sim
