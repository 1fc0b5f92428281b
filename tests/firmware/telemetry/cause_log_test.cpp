#include "firmware/telemetry/cause_log.h"

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

using std::chrono::seconds;

TEST(CauseLogTest, ACauseIsNewOnceWhileItLasts) {
  CauseLog log;
  Time now(seconds(10));
  EXPECT_TRUE(log.is_new("no such device", now));
  for (int k = 0; k < 1000; ++k) EXPECT_FALSE(log.is_new("no such device", now += seconds(1)));
  EXPECT_FALSE(log.is_new("no such device", now += CauseLog::kQuiet - seconds(1)));
  EXPECT_TRUE(log.is_new("no such device", now += CauseLog::kQuiet));
}

TEST(CauseLogTest, ACauseThatComesBackAndLastsIsNewAgain) {
  CauseLog log;
  Time now(seconds(10));
  EXPECT_TRUE(log.is_new("no such device", now));
  now += seconds(20);  // it works again for a while
  EXPECT_FALSE(log.is_new("no such device", now));
  int logged = 0;
  for (int k = 1; k < 3600; ++k) {
    const bool is_new = log.is_new("no such device", now += std::chrono::milliseconds(500));
    EXPECT_EQ(is_new, k == 10) << k;  // after five seconds
    logged += is_new ? 1 : 0;
  }
  EXPECT_EQ(logged, 1);
}

TEST(CauseLogTest, ACauseThatComesAndGoesIsNewOnce) {
  CauseLog log;
  Time now(seconds(10));
  int logged = 0;
  for (int k = 0; k < 100; ++k) logged += log.is_new("busy", now += seconds(20)) ? 1 : 0;
  EXPECT_EQ(logged, 1);
}

TEST(CauseLogTest, TwoCausesThatAlternateAreNewOnceEach) {
  CauseLog log;
  Time now(seconds(10));
  int logged = 0;
  for (int k = 0; k < 100; ++k) {
    logged += log.is_new("busy", now += seconds(1)) ? 1 : 0;
    logged += log.is_new("unplugged", now += seconds(1)) ? 1 : 0;
  }
  EXPECT_EQ(logged, 2);
}

TEST(CauseLogTest, ForgetsTheOldestOfManyCauses) {
  CauseLog log;
  Time now(seconds(10));
  for (size_t k = 0; k < CauseLog::kCauses; ++k) log.is_new(std::to_string(k), now += seconds(1));
  EXPECT_TRUE(log.is_new("one more", now += seconds(1)));
  EXPECT_FALSE(log.is_new("1", now));
  EXPECT_TRUE(log.is_new("0", now));
}

}  // namespace
}  // namespace bevloc::firmware
