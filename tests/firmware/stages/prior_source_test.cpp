#include "firmware/stages/prior_source.h"

#include <cmath>
#include <vector>

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

  /// Predicts 2 s of a bend that becomes tighter and tighter. Returns the true poses, one each
  /// millisecond.
  std::vector<Se2> predict_bend() {
    std::vector<Se2> truth{{}};
    for (int ms = 0; ms < 2000; ++ms) {
      const double yaw_rate_radps = 0.3 + 0.2 * 0.001 * ms;
      if (ms % 10 == 0) {
        Prediction prediction;
        prediction.pose.time = kTime + milliseconds(ms);
        prediction.pose.map_from_vehicle = truth.back();
        prediction.pose.speed_mps = kForwardSpeed_mps;
        prediction.pose.yaw_rate_radps = yaw_rate_radps;
        predictions_.push(prediction);
      }
      truth.push_back(truth.back() * arc_motion(kForwardSpeed_mps, yaw_rate_radps, 0.001));
    }
    return truth;
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

  PredictionQueue predictions_{256};
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

/// Few framesets per second, or some that were dropped.
TEST_F(PriorSourceTest, KnowsTheWayBetweenFramesetsThatLieFarApart) {
  for (const int apart_ms : {100, 200, 400}) {
    PriorSource priors(true, predictions_);
    const std::vector<Se2> truth = predict_bend();
    priors.take_predictions();
    constexpr int kFirst_ms = 900;  // the trail keeps 1.28 s
    EXPECT_FALSE(priors.at(frameset_at(kTime + milliseconds(kFirst_ms), Duration::zero()))->driven);
    const int next_ms = kFirst_ms + apart_ms;
    const auto prior = priors.at(frameset_at(kTime + milliseconds(next_ms), Duration::zero()));
    ASSERT_TRUE(prior && prior->driven) << apart_ms;
    EXPECT_EQ(prior->driven->to - prior->driven->from, milliseconds(apart_ms));
    const Se2 error =
        (truth[kFirst_ms].inverse() * truth[next_ms]).inverse() * prior->driven->motion;
    EXPECT_LT(error.translation().norm(), 0.01) << apart_ms;
    EXPECT_LT(std::abs(degrees(error.yaw_rad)), 0.05) << apart_ms;
  }
}

TEST_F(PriorSourceTest, KnowsNoWayAfterALongTimeWithoutFramesets) {
  PriorSource priors(true, predictions_);
  predict_bend();
  priors.take_predictions();
  ASSERT_TRUE(priors.at(frameset_at(kTime + milliseconds(900), Duration::zero())));
  const auto prior = priors.at(frameset_at(kTime + milliseconds(1400), Duration::zero()));
  ASSERT_TRUE(prior);
  EXPECT_FALSE(prior->driven);
}

}  // namespace
}  // namespace bevloc::firmware
