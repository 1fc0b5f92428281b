#include "pipeline/tracker/start_evidence.h"

#include <gtest/gtest.h>

namespace bevloc {
namespace {

constexpr double kFramePeriod_s = 0.1;
const Eigen::Vector3d kGnssAgrees = Eigen::Vector3d::Zero();
const Eigen::Vector3d kOneLaneFromGnss{0.3, 2.0, 0.0};

/// A match at the right place, on a road that nothing crosses.
constexpr StartMatch kRight{.score = 0.33, .sees = true};
/// One lane beside it: the lines along the road lie on each other, all else does not.
constexpr StartMatch kLaneBeside{.score = 0.25, .along_score = 0.04, .along_growth = 3.0, .sees = true};

class StartEvidenceTest : public testing::Test {
 protected:
  void see(const StartMatch& match, int frames, double speed_mps = 10.0) {
    for (int i = 0; i < frames; ++i) {
      time_s_ += kFramePeriod_s;
      evidence_.add(OdometrySample{.time = Time(from_seconds(time_s_)), .speed_mps = speed_mps});
      evidence_.add(match);
    }
  }

  bool suffices(const Eigen::Vector3d& gnss_error, double gnss_sigma_m = 1.2) const {
    return evidence_.suffices(gnss_error, gnss_sigma_m);
  }

  StartEvidence evidence_;
  double time_s_ = 0.0;
};

TEST_F(StartEvidenceTest, TheRightPlaceSufficesWithinASecond) {
  EXPECT_FALSE(suffices(kGnssAgrees));
  see(kRight, 10);
  EXPECT_TRUE(suffices(kGnssAgrees));
}

TEST_F(StartEvidenceTest, ALaneBesideNeverSufficesWhereGnssIsALaneAway) {
  for (int second = 0; second < 60; ++second) {
    see(kLaneBeside, 10);
    EXPECT_FALSE(suffices(kOneLaneFromGnss)) << second;
  }
}

TEST_F(StartEvidenceTest, ALowScoreSufficesOnlyAfterALongerWay) {
  constexpr StartMatch kWorn{.score = 0.23, .sees = true};
  see(kWorn, 10);
  EXPECT_FALSE(suffices(kGnssAgrees));
  see(kWorn, 20);
  EXPECT_TRUE(suffices(kGnssAgrees));
}

TEST_F(StartEvidenceTest, WhatCrossesTheRoadSpeaksForAPlaceWithALowScore) {
  see({.score = 0.21, .along_score = 0.24, .sees = true}, 10);
  EXPECT_TRUE(suffices(kGnssAgrees));
}

TEST_F(StartEvidenceTest, TheFartherFromGnssTheMoreIsNeeded) {
  see(kRight, 5);
  EXPECT_TRUE(suffices(kGnssAgrees));
  EXPECT_FALSE(suffices({0.0, 1.0, 0.0}));
  EXPECT_FALSE(suffices({-1.0, 0.0, 0.0}));
  see(kRight, 10);
  EXPECT_TRUE(suffices({0.0, 1.0, 0.0}));
  EXPECT_TRUE(suffices({-1.0, 0.0, 0.0}));
  EXPECT_TRUE(suffices({0.0, 0.0, 3.0})) << "the heading does not tell lanes apart";
}

TEST_F(StartEvidenceTest, AnExactGnssTellsLanesApartByItself) {
  see(kRight, 5);
  EXPECT_FALSE(suffices({0.0, 2.0, 0.0}, 1.2));
  EXPECT_TRUE(suffices({0.0, 2.0, 0.0}, 0.02)) << "4 cm";
}

TEST_F(StartEvidenceTest, AMatchThatSeesTooLittleAddsNothing) {
  StartMatch blind = kRight;
  blind.sees = false;
  see(blind, 100);
  EXPECT_FALSE(suffices(kGnssAgrees));
}

TEST_F(StartEvidenceTest, LowScoresTakeEvidenceAway) {
  see(kRight, 10);
  see({.score = 0.05, .sees = true}, 50);
  EXPECT_FALSE(suffices(kGnssAgrees));
}

TEST_F(StartEvidenceTest, AStandingVehicleSeesTheSameInAllMatches) {
  see(kRight, 1000, 0.0);
  EXPECT_TRUE(suffices(kGnssAgrees)) << "twenty good matches are enough";
  EXPECT_FALSE(suffices(kOneLaneFromGnss));
  see(kRight, 100, 10.0);
  EXPECT_TRUE(suffices(kOneLaneFromGnss));
}

TEST_F(StartEvidenceTest, AReversingVehicleSeesNewThings) {
  see(kRight, 1000, 0.0);
  see(kRight, 100, -10.0);
  EXPECT_TRUE(suffices(kOneLaneFromGnss));
}

TEST_F(StartEvidenceTest, AResetForgetsWhatWasSeen) {
  see(kRight, 100);
  evidence_.reset();
  EXPECT_FALSE(suffices(kGnssAgrees));
}

TEST_F(StartEvidenceTest, AGapOfTheOdometryCountsForHalfASecond) {
  see(kRight, 20, 0.0);
  evidence_.reset();
  see(kLaneBeside, 20, 0.0);  // uses up the matches that may count
  time_s_ += 3600.0;
  see(kRight, 1, 10.0);  // 5 m
  see(kRight, 100, 0.0);
  EXPECT_FALSE(suffices({0.0, 1.0, 0.0}));
}

}  // namespace
}  // namespace bevloc
