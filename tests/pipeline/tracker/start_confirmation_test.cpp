#include "pipeline/tracker/start_confirmation.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

constexpr double kFramePeriod_s = 0.1;
const Eigen::Vector3d kGnssAgrees = Eigen::Vector3d::Zero();
const Eigen::Vector3d kOneLaneFromGnss{0.3, 2.0, 0.0};

/// A match at the right place, on a road that nothing crosses.
constexpr StartMatch kRight{.score = 0.33, .sees = true};
/// One lane beside it: the lines along the road lie on each other, but nothing else does.
constexpr StartMatch kLaneBeside{
    .score = 0.25, .along_score = 0.04, .along_growth = 3.0, .sees = true};

class StartConfirmationTest : public testing::Test {
 protected:
  void see(const StartMatch& match, int frames, double speed_mps = 10.0) {
    for (int i = 0; i < frames; ++i) {
      time_s_ += kFramePeriod_s;
      start_.add(OdometrySample{.time = Time(from_seconds(time_s_)), .speed_mps = speed_mps});
      start_.add(match);
    }
  }

  bool confirms(const Eigen::Vector3d& gnss_error, double gnss_sigma_m = 1.2) const {
    return start_.confirms(gnss_error, gnss_sigma_m);
  }

  StartConfirmation start_;
  double time_s_ = 0.0;
};

TEST_F(StartConfirmationTest, TheRightPlaceConfirmsWithinASecond) {
  EXPECT_FALSE(confirms(kGnssAgrees));
  see(kRight, 10);
  EXPECT_TRUE(confirms(kGnssAgrees));
}

TEST_F(StartConfirmationTest, ALaneBesideNeverConfirmsWhereGnssIsALaneAway) {
  for (int second = 0; second < 60; ++second) {
    see(kLaneBeside, 10);
    EXPECT_FALSE(confirms(kOneLaneFromGnss)) << second;
  }
}

TEST_F(StartConfirmationTest, ALowScoreConfirmsOnlyAfterALongerWay) {
  constexpr StartMatch kWorn{.score = 0.21, .sees = true};
  see(kWorn, 10);
  EXPECT_FALSE(confirms(kGnssAgrees));
  see(kWorn, 20);
  EXPECT_TRUE(confirms(kGnssAgrees));
}

TEST_F(StartConfirmationTest, WhatCrossesTheRoadSpeaksForAPlaceWithALowScore) {
  see({.score = 0.21, .along_score = 0.24, .sees = true}, 10);
  EXPECT_TRUE(confirms(kGnssAgrees));
}

TEST_F(StartConfirmationTest, TheFartherFromGnssTheMoreIsNeeded) {
  see(kRight, 5);
  EXPECT_TRUE(confirms(kGnssAgrees));
  EXPECT_FALSE(confirms({0.0, 1.0, 0.0}));
  EXPECT_FALSE(confirms({-1.0, 0.0, 0.0}));
  see(kRight, 10);
  EXPECT_TRUE(confirms({0.0, 1.0, 0.0}));
  EXPECT_TRUE(confirms({-1.0, 0.0, 0.0}));
  EXPECT_TRUE(confirms({0.0, 0.0, 3.0})) << "the heading does not tell lanes apart";
}

TEST_F(StartConfirmationTest, AnExactGnssTellsLanesApartByItself) {
  see(kRight, 5);
  EXPECT_FALSE(confirms({0.0, 2.0, 0.0}, 1.2));
  EXPECT_TRUE(confirms({0.0, 2.0, 0.0}, 0.02)) << "4 cm";
}

TEST_F(StartConfirmationTest, AMatchThatSeesTooLittleAddsNothing) {
  StartMatch blind = kRight;
  blind.sees = false;
  see(blind, 100);
  EXPECT_FALSE(confirms(kGnssAgrees));
}

TEST_F(StartConfirmationTest, LowScoresTakeSupportAway) {
  see(kRight, 10);
  see({.score = 0.05, .sees = true}, 50);
  EXPECT_FALSE(confirms(kGnssAgrees));
}

TEST_F(StartConfirmationTest, AStandingVehicleSeesTheSameInAllMatches) {
  see(kRight, 1000, 0.0);
  EXPECT_TRUE(confirms(kGnssAgrees)) << "twenty good matches are enough";
  EXPECT_FALSE(confirms(kOneLaneFromGnss));
  see(kRight, 100, 10.0);
  EXPECT_TRUE(confirms(kOneLaneFromGnss));
}

TEST_F(StartConfirmationTest, AReversingVehicleSeesNewThings) {
  see(kRight, 1000, 0.0);
  see(kRight, 100, -10.0);
  EXPECT_TRUE(confirms(kOneLaneFromGnss));
}

TEST_F(StartConfirmationTest, AResetForgetsWhatWasSeen) {
  see(kRight, 100);
  start_.reset();
  EXPECT_FALSE(confirms(kGnssAgrees));
}

TEST_F(StartConfirmationTest, AGapOfTheOdometryCountsForHalfASecond) {
  see(kRight, 20, 0.0);
  start_.reset();
  see(kLaneBeside, 20, 0.0);  // uses up the matches that may count
  time_s_ += 3600.0;
  see(kRight, 1, 10.0);  // 5 m
  see(kRight, 100, 0.0);
  EXPECT_FALSE(confirms({0.0, 1.0, 0.0}));
}

}  // namespace
}  // namespace bevloc
