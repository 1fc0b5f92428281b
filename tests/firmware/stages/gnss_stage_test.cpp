#include "firmware/stages/gnss_stage.h"

#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "can/messages/vehicle_encoder.h"
#include "can/messages/vehicle_input.h"
#include "drivers/clock/clock.h"
#include "firmware/stages/vehicle_input_stage.h"
#include "tests/support/mock_gpsd.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr can::GeodeticPosition kMapOrigin{49.0112, 8.4044};
/// What gpsd says arrives within this time.
constexpr Duration kPatience = seconds(5);

drivers::GnssFix fix_to_the_east() {
  return {.latitude_deg = kMapOrigin.latitude_deg,
          .longitude_deg = kMapOrigin.longitude_deg,
          .sigma_north_m = 3.0,
          .sigma_east_m = 0.1,
          .speed_mps = 20.0,
          .course_deg = 90.0,
          .sigma_course_deg = 1.0};
}

GnssSample sample_of(const drivers::GnssFix& fix, Duration time_sigma,
                     const GnssConfig& config = {}) {
  can::GeoReference geo(kMapOrigin);
  return gnss_sample_of(fix, {drivers::FixVerdict::kUsable, Time(seconds(5)), time_sigma}, config,
                        geo);
}

TEST(GnssSampleTest, HasAtLeastTheConfiguredSigma) {
  const GnssSample sample = sample_of(fix_to_the_east(), Duration::zero());
  EXPECT_DOUBLE_EQ(sample.sigma_east_m, 0.5);
  EXPECT_DOUBLE_EQ(sample.sigma_north_m, 3.0);
  EXPECT_EQ(sample.time, Time(seconds(5)));
  EXPECT_NEAR(sample.east_m, 0.0, 1e-6);
}

TEST(GnssSampleTest, WhatTheTimeDoesNotKnowIsDistance) {
  GnssConfig config;
  config.min_sigma_m = 3.0;
  EXPECT_NEAR(sample_of(fix_to_the_east(), milliseconds(200), config).sigma_east_m, 5.0, 1e-9);
  drivers::GnssFix unknown = fix_to_the_east();
  unknown.speed_mps.reset();
  EXPECT_NEAR(sample_of(unknown, milliseconds(100), config).sigma_east_m, 5.0, 1e-9) << "40 m/s";
}

TEST(GnssSampleTest, TheCourseIsTheHeadingOnlyWhenFast) {
  drivers::GnssFix fix = fix_to_the_east();
  const GnssSample fast = sample_of(fix, Duration::zero());
  ASSERT_TRUE(fast.yaw);
  EXPECT_NEAR(fast.yaw->yaw_rad, 0.0, 1e-6);
  EXPECT_NEAR(fast.yaw->sigma_rad, radians(3.0), 1e-9);
  fix.speed_mps = 4.9;
  EXPECT_FALSE(sample_of(fix, Duration::zero()).yaw);
}

TEST(GnssSampleTest, AnAntennaInFrontMakesTheCourseLessCertain) {
  GnssConfig config;
  config.antenna = {.x_m = 2.0, .y_m = 0.0};
  drivers::GnssFix fix = fix_to_the_east();
  fix.speed_mps = 5.0;
  const GnssSample sample = sample_of(fix, Duration::zero(), config);
  EXPECT_NEAR(sample.yaw->sigma_rad, std::hypot(radians(3.0), 0.16), 1e-9);
  ASSERT_TRUE(sample.antenna);
  EXPECT_EQ(sample.antenna->x_m, 2.0);
}

/// A stage that is connected with a gpsd of the test.
class GnssStageTest : public testing::Test {
 protected:
  GnssStageTest() {
    config_.gpsd.port = gpsd_.port();
    config_.clock.latency = milliseconds(100);
    stage_.emplace(config_, kMapOrigin, clock_, samples_);
    stage_->step(Duration::zero());
    gpsd_.accept_client();
    if (!stage_->counters().connected) stage_->step(kPatience);
  }

  void say_fix(int second, const char* more = "") const {
    gpsd_.say(fmt::format(
        R"({{"class":"TPV","mode":3,"time":"2026-11-23T22:23:{:02}.000Z","lat":49.0112,)"
        R"("lon":8.4044,"epx":2.0,"epy":2.0,"speed":0.1{}}})"
        "\r\n",
        second, more));
  }
  uint64_t fixes(drivers::FixVerdict verdict) const {
    return stage_->counters().fixes[static_cast<size_t>(verdict)];
  }

  test::MockGpsd gpsd_;
  drivers::VirtualClock clock_{Time(seconds(100))};
  VehicleQueue samples_{8};
  GnssConfig config_;
  std::optional<GnssStage> stage_;
};

TEST_F(GnssStageTest, QueuesSamplesWithTheirOwnTime) {
  for (int second = 1; second <= 3; ++second) {
    say_fix(second);
    stage_->step(kPatience);
    clock_.advance(seconds(1));
  }
  const auto sample = samples_.pop(Duration::zero());
  ASSERT_TRUE(sample) << "the third fix";
  EXPECT_EQ(std::get<GnssSample>(*sample).time, Time(seconds(102)) - milliseconds(100));
  EXPECT_FALSE(samples_.pop(Duration::zero()));
  EXPECT_EQ(stage_->counters().samples, 1U);
  EXPECT_EQ(fixes(drivers::FixVerdict::kLearning), 2U);
  EXPECT_TRUE(stage_->counters().connected);
  EXPECT_EQ(stage_->counters().max_age, milliseconds(100));
}

TEST_F(GnssStageTest, TellsTheFixesThatItUsesSoThatAReplayCanRepeatThem) {
  std::vector<std::pair<drivers::GnssFix, drivers::FixTime>> told;
  stage_->observe([&told](const drivers::GnssFix& fix, const drivers::FixTime& time) {
    told.emplace_back(fix, time);
  });
  for (int second = 1; second <= 3; ++second) {
    say_fix(second);
    stage_->step(kPatience);
    clock_.advance(seconds(1));
  }
  ASSERT_EQ(told.size(), 1U) << "the first two fixes only teach the clock";
  const auto used = std::get<GnssSample>(samples_.pop(Duration::zero()).value());
  GnssStage repeated(config_, kMapOrigin, clock_, samples_);
  repeated.take(told[0].first, told[0].second);
  const auto sample = std::get<GnssSample>(samples_.pop(Duration::zero()).value());
  EXPECT_EQ(sample.time, used.time);
  EXPECT_EQ(sample.east_m, used.east_m);
  EXPECT_EQ(sample.north_m, used.north_m);
  EXPECT_EQ(sample.sigma_east_m, used.sigma_east_m);
  EXPECT_EQ(repeated.counters().samples, 1U);
}

TEST_F(GnssStageTest, CountsWhatItRefuses) {
  for (int second = 1; second <= 3; ++second) {
    say_fix(second);
    stage_->step(kPatience);
    clock_.advance(seconds(1));
  }
  clock_.advance(seconds(2));
  say_fix(4);
  stage_->step(kPatience);
  gpsd_.say("{\"class\":\"TPV\",\"mode\":1}\n!!\n");
  stage_->step(kPatience);
  const GnssCounters counters = stage_->counters();
  EXPECT_EQ(counters.samples, 1U);
  EXPECT_EQ(fixes(drivers::FixVerdict::kStale), 1U);
  EXPECT_EQ(counters.gpsd.lines[static_cast<size_t>(drivers::GpsdLine::kNoFix)], 1U);
  EXPECT_EQ(counters.gpsd.lines[static_cast<size_t>(drivers::GpsdLine::kNotReadable)], 1U);
}

/// With gpsd, positions of the bus are not used, because two receivers would count twice.
TEST(VehicleInputStageTest, DropsPositionsOfTheBusWithGpsd) {
  for (const bool with_gpsd : {false, true}) {
    can::MockWire wire;
    const auto vehicle = wire.connect();
    const auto localizer = wire.connect();
    VehicleQueue samples(8);
    VehicleInputStage stage(
        *localizer, std::make_unique<can::VehicleInput>(can::BaseIds{}, kMapOrigin, 1.6), samples);
    if (with_gpsd) stage.ignore_gnss();
    can::VehicleEncoder encoder(can::BaseIds{}, kMapOrigin, 1.6);
    for (int i = 1; i <= 5; ++i) {
      const Time now(milliseconds(100 * i));
      for (const can::Frame& frame :
           encoder.gnss({.time = now, .sigma_east_m = 1.0, .sigma_north_m = 1.0})) {
        vehicle->send(frame, now);
      }
      stage.step(drivers::VirtualClock(now), Duration::zero());
    }
    EXPECT_GT(stage.counters().gnss_samples, 0U);
    EXPECT_EQ(samples.pop(Duration::zero()).has_value(), !with_gpsd);
  }
}

TEST(VehicleInputStageTest, UsesTheNewSpeedAfterASuspension) {
  can::MockWire wire;
  const auto vehicle = wire.connect();
  const auto localizer = wire.connect();
  VehicleQueue samples(8);
  VehicleInputStage stage(
      *localizer, std::make_unique<can::VehicleInput>(can::BaseIds{}, kMapOrigin, 1.6), samples);
  can::VehicleEncoder encoder(can::BaseIds{}, kMapOrigin, 1.6);
  drivers::VirtualClock clock;
  const auto drive = [&](double speed_mps) {
    for (int i = 0; i < 10; ++i) {
      clock.advance(milliseconds(20));
      for (const can::Frame& frame : encoder.odometry({.speed_mps = speed_mps})) {
        vehicle->send(frame, clock.now());
      }
      stage.step(clock, Duration::zero());
    }
  };
  drive(12.0);
  clock.suspend(seconds(3));
  drive(6.0);
  EXPECT_EQ(stage.counters().odometry_samples, 20U);
  EXPECT_EQ(stage.why(clock.now()), WhyMask{});
}

}  // namespace
}  // namespace bevloc::firmware
