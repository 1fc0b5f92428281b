#include "firmware/stages/prior_source.h"

#include <gtest/gtest.h>

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;

constexpr Time kTime{milliseconds(1000)};
constexpr double kForwardSpeed_mps = 10.0;

class PriorSourceTest : public testing::Test {
 protected:
  void predict(Time time, bool acquiring) {
    Prediction prediction;
    prediction.pose.time = time;
    prediction.pose.map_from_vehicle.x_m = kForwardSpeed_mps * to_seconds(time - kTime);
    prediction.pose.speed_mps = kForwardSpeed_mps;
    prediction.acquiring = acquiring;
    predictions_.push(prediction);
  }

  /// A frameset at `time` whose last camera exposes `later` than the others.
  static drivers::Frameset frameset_at(Time time, Duration later) {
    drivers::Frameset frameset;
    frameset.time = time;
    frameset.present.set();
    for (drivers::Frame& frame : frameset.frames) frame.time = time;
    frameset.frames.back().time = time + later;
    return frameset;
  }

  PredictionQueue predictions_{16};
};

TEST_F(PriorSourceTest, KnowsNothingBeforeThePredictions) {
  PriorSource priors(true, predictions_);
  priors.take_predictions();
  EXPECT_FALSE(priors.at(frameset_at(kTime, Duration::zero())));
}

TEST_F(PriorSourceTest, GivesPoseSpeedAndMotionAtTheTimeOfTheFrameset) {
  PriorSource priors(true, predictions_);
  predict(kTime, true);
  predict(kTime + milliseconds(100), false);
  priors.take_predictions();
  const auto prior = priors.at(frameset_at(kTime + milliseconds(20), milliseconds(30)));
  ASSERT_TRUE(prior);
  EXPECT_NEAR(prior->map_from_vehicle.x_m, 0.2, 1e-9);
  EXPECT_DOUBLE_EQ(prior->speed_mps, kForwardSpeed_mps);
  EXPECT_EQ(prior->range, SearchRange::kTracking) << "the latest prediction decides";
  EXPECT_EQ(prior->reference_from_exposure.front().x_m, 0.0);
  EXPECT_NEAR(prior->reference_from_exposure.back().x_m, 0.3, 1e-9);
}

TEST_F(PriorSourceTest, GivesNoMotionIfItIsNotCompensated) {
  PriorSource priors(false, predictions_);
  predict(kTime, true);
  priors.take_predictions();
  const auto prior = priors.at(frameset_at(kTime, milliseconds(30)));
  ASSERT_TRUE(prior);
  EXPECT_EQ(prior->range, SearchRange::kAcquiring);
  EXPECT_EQ(prior->reference_from_exposure.back().x_m, 0.0);
}

TEST_F(PriorSourceTest, GivesNothingIfTheMotionToOneExposureIsNotKnown) {
  PriorSource priors(true, predictions_);
  predict(kTime, true);
  priors.take_predictions();
  const Time last = kTime + PoseTrail::kReach;
  EXPECT_TRUE(priors.at(frameset_at(last, Duration::zero())));
  EXPECT_FALSE(priors.at(frameset_at(last, milliseconds(40))));
}

}  // namespace
}  // namespace bevloc::firmware
