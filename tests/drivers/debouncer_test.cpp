#include "drivers/gpio/debouncer.h"

#include <gtest/gtest.h>

namespace bevloc::drivers {
namespace {

using std::chrono::milliseconds;

Time at_ms(int ms) {
  return Time(milliseconds(ms));
}

TEST(Debouncer, TakesALevelThatHolds) {
  Debouncer line(true, milliseconds(50));
  line.see(false, at_ms(100));
  EXPECT_TRUE(line.settled_at(at_ms(149)));
  EXPECT_FALSE(line.settled_at(at_ms(150)));
}

TEST(Debouncer, IgnoresADip) {
  Debouncer line(true, milliseconds(50));
  line.see(false, at_ms(100));
  line.see(true, at_ms(149));
  EXPECT_TRUE(line.settled_at(at_ms(1000)));
}

TEST(Debouncer, CountsFromTheLastBounce) {
  Debouncer line(true, milliseconds(50));
  for (int k = 0; k < 5; ++k) {
    line.see(false, at_ms(100 + 20 * k));
    line.see(true, at_ms(110 + 20 * k));
  }
  line.see(false, at_ms(200));
  line.see(false, at_ms(230));
  EXPECT_TRUE(line.settled_at(at_ms(249)));
  EXPECT_FALSE(line.settled_at(at_ms(250)));
}

TEST(Debouncer, KeepsALevelThatHeldBeforeTheNextEdge) {
  Debouncer line(true, milliseconds(50));
  line.see(false, at_ms(100));
  line.see(true, at_ms(180));
  EXPECT_FALSE(line.settled_at(at_ms(181)));
  EXPECT_TRUE(line.settled_at(at_ms(230)));
}

TEST(Debouncer, WithoutHoldTimeALevelCountsAtOnce) {
  Debouncer line(true, Duration::zero());
  line.see(false, at_ms(100));
  EXPECT_FALSE(line.settled_at(at_ms(100)));
}

}  // namespace
}  // namespace bevloc::drivers
