#include "can/bus/back_off.h"

#include <gtest/gtest.h>

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;

TEST(BackOff, DoublesUpToItsLimitAndStartsAnewAfterASuccess) {
  BackOff back_off(milliseconds(20), milliseconds(70));
  Time now{};
  EXPECT_TRUE(back_off.is_due(now));
  for (const int delay_ms : {20, 40, 70, 70}) {
    back_off.note_failure(now);
    EXPECT_FALSE(back_off.is_due(now + milliseconds(delay_ms - 1)));
    now += milliseconds(delay_ms);
    EXPECT_TRUE(back_off.is_due(now));
  }
  back_off.reset();
  EXPECT_TRUE(back_off.is_due(Time{}));
  back_off.note_failure(now);
  EXPECT_TRUE(back_off.is_due(now + milliseconds(20)));
}

}  // namespace
}  // namespace bevloc::can
