#include "firmware/stages/stamp_watch.h"

#include <cmath>

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

/// A vehicle on a winding road, with a yaw rate every 20 ms and a report every 100 ms.
class StampWatchTest : public testing::Test {
 protected:
  /// The stamps are late by `late_s`. Vision reports the jumps that `jumped_` and `jumps_` say.
  void drive(double duration_s, double late_s) {
    const int end = step_ + static_cast<int>(std::lround(100.0 * duration_s));
    for (; step_ < end; ++step_) {
      const double time_s = 0.01 * step_;
      if (step_ % 2 == 0) watch_.add_rate(time_at(step_), 0.3 * std::sin(0.5 * time_s));
      if (step_ % 10 == 0) report(late_s);
    }
  }

  /// A match of the images of 180 ms ago.
  void report(double late_s) {
    const int exposed = step_ - 18;
    VisionReport report;
    report.frame_time = time_at(exposed);
    report.stamps_jumped = jumped_;
    report.stamp_jumps = jumps_;
    report.had_prior = true;
    report.match.evidence = Evidence::kGood;
    report.prior.yaw_rad = 0.6 * (1.0 - std::cos(0.5 * (0.01 * exposed - late_s)));
    watch_.add_report(report);
  }

  void jump() {
    jumped_ = true;
    ++jumps_;
  }
  void jump_back() {
    jumped_ = false;
    ++jumps_;
  }

  /// Stamps that jump although bends show that they are right. So they were wrong before.
  void jump_to_right_stamps() {
    jump();
    drive(60.0, 0.0);
    ASSERT_FALSE(watch_.contradicts());
  }

  static Time time_at(int step) { return Time(milliseconds(1000 + 10 * step)); }

  int step_ = 0;  ///< of 10 ms
  bool jumped_ = false;
  uint64_t jumps_ = 0;
  StampWatch watch_;
};

TEST_F(StampWatchTest, StampsThatJumpAreWrongUntilTheyJumpBack) {
  drive(60.0, 0.0);
  jump();
  report(0.1);
  EXPECT_TRUE(watch_.contradicts());
  drive(60.0, 0.1);
  EXPECT_NEAR(watch_.offset_ms(), 100, 40) << "bends show it, too";
  jump_back();
  report(0.0);
  EXPECT_FALSE(watch_.contradicts());
  EXPECT_EQ(watch_.offset_ms(), 0);
}

TEST_F(StampWatchTest, WrongStampsAreStillWrongAfterAJumpThereAndBack) {
  drive(60.0, 0.1);
  ASSERT_TRUE(watch_.contradicts());
  jump();
  report(0.1);
  EXPECT_TRUE(watch_.contradicts());
  jump_back();
  report(0.1);
  EXPECT_TRUE(watch_.contradicts());
  EXPECT_NEAR(watch_.offset_ms(), 100, 40);
  drive(120.0, 0.0);
  EXPECT_FALSE(watch_.contradicts()) << "bends show that they are right";
}

TEST_F(StampWatchTest, AFurtherJumpCountsAfterBendsOverruledTheFirst) {
  jump_to_right_stamps();
  report(0.0);
  EXPECT_FALSE(watch_.contradicts());
  jump();
  report(0.1);
  EXPECT_TRUE(watch_.contradicts());
  drive(1.0, 0.1);
  EXPECT_TRUE(watch_.contradicts());
}

TEST_F(StampWatchTest, AJumpBackCountsAfterBendsOverruledTheJump) {
  jump_to_right_stamps();
  jump_back();
  report(0.1);
  EXPECT_TRUE(watch_.contradicts());
  watch_.note_gap();
  report(0.1);
  EXPECT_TRUE(watch_.contradicts()) << "a gap does not set the stamps right";
  drive(60.0, 0.0);
  EXPECT_FALSE(watch_.contradicts()) << "bends show that they are right";
}

TEST_F(StampWatchTest, AGapKeepsWhatBendsFoundAboutAJump) {
  jump_to_right_stamps();
  watch_.note_gap();
  report(0.0);
  EXPECT_FALSE(watch_.contradicts()) << "the stamps are still right";
  jump_back();
  report(0.1);
  EXPECT_TRUE(watch_.contradicts()) << "the stamps from before the jump were wrong";
}

}  // namespace
}  // namespace bevloc::firmware
