#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "can/publisher/solution_frames.h"
#include "tests/firmware/stages/estimation_stage_fixture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using test::EstimationStageTest;

/// Returns `begin` at the first look. Before all further looks, the thread has stood still for
/// `stall`, and the machine was suspended for `suspension`.
class StallingClock final : public drivers::Clock {
 public:
  explicit StallingClock(Time begin, Duration stall, Duration suspension = Duration::zero())
      : begin_(begin), stall_(stall), suspension_(suspension) {}

  Time now() const override { return std::exchange(looked_, true) ? begin_ + stall_ : begin_; }
  void sleep_until(Time /*time*/) override {}
  Duration suspended() const override {
    return std::exchange(asked_, true) ? suspension_ : Duration::zero();
  }
  Duration unsteered() const override { return begin_.time_since_epoch(); }

 private:
  const Time begin_;
  const Duration stall_;
  const Duration suspension_;
  mutable bool looked_ = false;
  mutable bool asked_ = false;
};

constexpr can::ClockReport kPtpClock{
    .source = can::TimeSource::kPtp, .utc_offset = milliseconds(7), .utc_error = {}};

TEST_F(EstimationStageTest, AClockGapMeansLostUntilThePoseIsFoundAgain) {
  run(milliseconds(5000));
  ASSERT_EQ(stage_.counters().state, HealthState::kTracking);
  now_ += std::chrono::seconds(10);
  samples_.push(GnssSample{now_ - std::chrono::seconds(10), 0.0, 0.0, 1.0, 1.0, {}});
  latest_.reset();
  run(milliseconds(10));
  EXPECT_EQ(stage_.counters().state, HealthState::kLost);
  EXPECT_TRUE(why().has(Why::kClockGap));
  EXPECT_EQ(stage_.counters().clock_gaps, 1U);
  run(milliseconds(200));
  EXPECT_FALSE(latest_) << "no valid pose";
  run(milliseconds(5000));
  EXPECT_EQ(stage_.counters().state, HealthState::kTracking);
  EXPECT_FALSE(why().has(Why::kClockGap));
}

/// The steady clock stands still meanwhile, so odometry misses the 2.5 m that the vehicle drives.
TEST_F(EstimationStageTest, AShortSuspensionIsAClockGap) {
  run(milliseconds(5000));
  ASSERT_EQ(stage_.counters().state, HealthState::kTracking);
  suspended_ += milliseconds(250);
  latest_.reset();
  run(milliseconds(10));
  EXPECT_EQ(stage_.counters().state, HealthState::kLost);
  EXPECT_TRUE(why().has(Why::kClockGap));
  EXPECT_EQ(stage_.counters().clock_gaps, 1U);
  EXPECT_FALSE(latest_) << "no valid pose";
}

/// Only GNSS supports a new pose, and its sigma may be too small.
TEST_F(EstimationStageTest, ThePoseAfterAClockGapIsNew) {
  run(milliseconds(5000));
  now_ += std::chrono::seconds(10);
  vision_ = false;
  gnss_sigma_m_ = 0.1;
  run(milliseconds(300));
  std::optional<Prediction> latest;
  while (const auto prediction = predictions_.pop(Duration::zero())) latest = prediction;
  ASSERT_TRUE(latest);
  EXPECT_GT(latest->pose.covariance(1, 1), 0.5);
}

TEST_F(EstimationStageTest, TellsTheSourceOfTime) {
  std::vector<can::PoseReport> reports;
  stage_.observe_reports([&](const can::PoseReport& report) { reports.push_back(report); });
  run(milliseconds(10));
  note_clock(kPtpClock);
  run(milliseconds(10));
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_EQ(reports[0].status.time_source, can::TimeSource::kFreeRunning);
  EXPECT_EQ(reports[1].status.time_source, can::TimeSource::kPtp);
  EXPECT_EQ(reports[1].clock.utc_offset, kPtpClock.utc_offset);
  EXPECT_EQ(stage_.counters().time_source, can::TimeSource::kPtp);
}

/// A suspension changes the offset to UTC by its whole length.
TEST_F(EstimationStageTest, AfterAClockGapTheClockIsUnknownUntilItIsNotedAgain) {
  can::PoseReport latest;
  stage_.observe_reports([&](const can::PoseReport& report) { latest = report; });
  note_clock(kPtpClock);
  run(milliseconds(10));
  ASSERT_EQ(latest.clock.source, can::TimeSource::kPtp);
  suspended_ += std::chrono::hours(8);
  for (int cycle = 0; cycle < 10; ++cycle) {
    run(milliseconds(10));
    EXPECT_EQ(latest.clock.source, can::TimeSource::kFreeRunning) << "LOC_Clock is not available";
    EXPECT_EQ(latest.status.time_source, can::TimeSource::kFreeRunning);
    EXPECT_EQ(stage_.counters().time_source, can::TimeSource::kFreeRunning);
  }
  can::ClockReport noted = kPtpClock;
  noted.utc_offset += std::chrono::hours(8);
  note_clock(noted);
  run(milliseconds(10));
  EXPECT_EQ(latest.status.time_source, can::TimeSource::kPtp);
  EXPECT_EQ(latest.clock.source, can::TimeSource::kPtp);
  EXPECT_EQ(latest.clock.utc_offset, noted.utc_offset);
}

TEST_F(EstimationStageTest, AStallOfTheThreadIsAClockGapForTheClock) {
  note_clock(kPtpClock);
  run(milliseconds(100));
  ASSERT_EQ(stage_.counters().time_source, can::TimeSource::kPtp);
  now_ += std::chrono::seconds(1);
  run(milliseconds(10));
  EXPECT_EQ(stage_.counters().clock_gaps, 1U);
  EXPECT_EQ(stage_.counters().time_source, can::TimeSource::kFreeRunning);
}

/// The machine was suspended after the clock was read and before the note arrives.
TEST_F(EstimationStageTest, AClockThatWasReadBeforeAGapIsNotTold) {
  can::PoseReport latest;
  stage_.observe_reports([&](const can::PoseReport& report) { latest = report; });
  note_clock(kPtpClock);
  run(milliseconds(10));
  ASSERT_EQ(latest.clock.source, can::TimeSource::kPtp);
  const uint64_t gaps_before = stage_.counters().clock_gaps;
  suspended_ += std::chrono::hours(8);
  run(milliseconds(10));
  stage_.note_clock(kPtpClock, gaps_before);
  run(milliseconds(10));
  EXPECT_EQ(latest.clock.source, can::TimeSource::kFreeRunning);
  EXPECT_EQ(latest.status.time_source, can::TimeSource::kFreeRunning);
}

TEST_F(EstimationStageTest, APoseThatGetsOldBeforeItIsSentIsLost) {
  can::PoseReport latest;
  stage_.observe_reports([&](const can::PoseReport& report) { latest = report; });
  run(milliseconds(5000));
  ASSERT_EQ(reader_.state(), HealthState::kTracking);
  ASSERT_EQ(stage_.counters().lost, 0U);
  latest_.reset();
  tick(StallingClock(now_, milliseconds(60)));
  EXPECT_FALSE(latest_) << "no valid pose";
  EXPECT_EQ(reader_.state(), HealthState::kLost);
  EXPECT_TRUE(reader_.why().has(Why::kPoseStale));
  EXPECT_EQ(latest.status.state, HealthState::kLost);
  EXPECT_EQ(stage_.counters().lost, 1U);
  EXPECT_TRUE(WhyMask::from_bits(stage_.counters().lost_why).has(Why::kPoseStale));
  now_ += milliseconds(60);
  run(milliseconds(500));
  EXPECT_EQ(reader_.state(), HealthState::kTracking);
  EXPECT_TRUE(latest_);
}

/// The clock stands still during the suspension.
TEST_F(EstimationStageTest, APoseFromBeforeASuspensionIsLostAndSoIsTheClock) {
  can::PoseReport latest;
  stage_.observe_reports([&](const can::PoseReport& report) { latest = report; });
  note_clock(kPtpClock);
  run(milliseconds(5000));
  ASSERT_EQ(reader_.state(), HealthState::kTracking);
  ASSERT_EQ(latest.clock.source, can::TimeSource::kPtp);
  latest_.reset();
  tick(StallingClock(now_, Duration::zero(), std::chrono::hours(8)));
  EXPECT_FALSE(latest_) << "no valid pose";
  EXPECT_EQ(reader_.state(), HealthState::kLost);
  EXPECT_TRUE(reader_.why().has(Why::kPoseStale));
  EXPECT_EQ(latest.clock.source, can::TimeSource::kFreeRunning);
  EXPECT_EQ(latest.status.time_source, can::TimeSource::kFreeRunning);
}

TEST_F(EstimationStageTest, AShortStallKeepsThePoseAndTheTimeThatItHoldsAt) {
  can::PoseReport latest;
  stage_.observe_reports([&](const can::PoseReport& report) { latest = report; });
  run(milliseconds(5000));
  latest_.reset();
  tick(StallingClock(now_, can::kMaxPoseAge));
  EXPECT_TRUE(latest_);
  EXPECT_EQ(reader_.state(), HealthState::kTracking);
  EXPECT_EQ(latest.pose_time, now_);
}

TEST_F(EstimationStageTest, StampsAreStillWrongAfterAClockGap) {
  run(milliseconds(5000));
  stamps_jumped_ = true;
  run(milliseconds(200));
  now_ += std::chrono::seconds(10);
  latest_.reset();
  run(milliseconds(5000));
  EXPECT_FALSE(latest_) << "no valid pose";
  EXPECT_TRUE(why().has(Why::kCalibrationFault));
}

/// Until the gap there are no matches, so the pose is not valid and the arbiter does not exclude
/// GNSS.
TEST_F(EstimationStageTest, GnssIsStillTooOldAfterAClockGap) {
  winding_ = true;
  gnss_heading_age_s_ = 0.5;
  vision_ = false;
  run(milliseconds(30'000));
  ASSERT_GT(stage_.counters().gnss_lag_ms, 0);
  now_ += std::chrono::seconds(10);
  vision_ = true;
  run(milliseconds(1000));
  EXPECT_GT(stage_.counters().gnss_lag_ms, 0);
  EXPECT_TRUE(why().has(Why::kGnssContradicts));
  run(milliseconds(4000));
  EXPECT_FALSE(latest_) << "no valid pose";
}

TEST_F(EstimationStageTest, AMapThatLiesOffGnssDoesSoAfterAClockGap) {
  run(milliseconds(5000));
  gnss_north_m_ = 3.0;
  for (int second = 0; second < 600 && !why().has(Why::kMapFault); ++second) {
    run(milliseconds(1000));
  }
  ASSERT_TRUE(why().has(Why::kMapFault));
  now_ += std::chrono::seconds(10);
  latest_.reset();
  run(milliseconds(10'000));
  EXPECT_FALSE(latest_) << "no valid pose";
  EXPECT_TRUE(why().has(Why::kMapFault));
}

}  // namespace
}  // namespace bevloc::firmware
