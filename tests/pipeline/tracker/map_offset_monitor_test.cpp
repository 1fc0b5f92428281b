#include "pipeline/tracker/map_offset_monitor.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace bevloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr double kCorrelation_s = 40.0;
constexpr double kSigma_m = 1.0;

class MapOffsetMonitorTest : public testing::Test {
 protected:
  explicit MapOffsetMonitorTest(unsigned seed = 1) : random_(seed) { error_m_ = drawn(kSigma_m); }

  /// Drives with GNSS errors of the assumed kind. Returns how long there was a contradiction.
  Duration drive(const Eigen::Vector2d& offset_m, Duration duration) {
    Duration contradicted{};
    const double kept = std::exp(-0.1 / kCorrelation_s);
    for (const Time end = now_ + duration; now_ < end; now_ += milliseconds(100)) {
      error_m_ = kept * error_m_ + drawn(kSigma_m * std::sqrt(1.0 - kept * kept));
      monitor_.add(now_, offset_m + error_m_ + drawn(0.3), kSigma_m);
      if (monitor_.contradicts()) contradicted += milliseconds(100);
    }
    return contradicted;
  }

  Eigen::Vector2d drawn(double sigma_m) {
    // Two draws among the arguments of one call would come in an order that depends on the
    // compiler.
    const double north_m = sigma_m * normal_(random_);
    const double east_m = sigma_m * normal_(random_);
    return Eigen::Vector2d(east_m, north_m);
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  MapOffsetMonitor monitor_{kCorrelation_s};
  Eigen::Vector2d error_m_;
  Time now_{seconds(100)};
};

TEST_F(MapOffsetMonitorTest, GnssErrorsAloneAreNoOffset) {
  EXPECT_EQ(drive(Eigen::Vector2d::Zero(), std::chrono::hours(20)), Duration::zero());
}

TEST_F(MapOffsetMonitorTest, AnOffsetOf3MetresIsFoundWithinFourMinutes) {
  drive({3.0, 0.0}, minutes(4));
  ASSERT_TRUE(monitor_.contradicts());
  EXPECT_NEAR(monitor_.offset_m().x(), 3.0, 1.5);
  EXPECT_NEAR(monitor_.offset_m().y(), 0.0, 1.5);
}

TEST_F(MapOffsetMonitorTest, AnOffsetOfAMetreIsFoundWithinAnHour) {
  drive({-0.8, 0.8}, minutes(60));
  EXPECT_TRUE(monitor_.contradicts());
}

/// What the filter has learned on a right map makes it slow. docs/tracker-and-health.md states it.
class MapOffsetAfterAnHour : public MapOffsetMonitorTest,
                             public testing::WithParamInterface<unsigned> {
 protected:
  MapOffsetAfterAnHour() : MapOffsetMonitorTest(GetParam()) {}
};

TEST_P(MapOffsetAfterAnHour, AnOffsetOf3MetresIsFoundWithin20Minutes) {
  EXPECT_EQ(drive(Eigen::Vector2d::Zero(), minutes(60)), Duration::zero());
  drive({3.0, 0.0}, minutes(20));
  EXPECT_TRUE(monitor_.contradicts());
}

INSTANTIATE_TEST_SUITE_P(Seeds, MapOffsetAfterAnHour, testing::Range(1U, 11U));

TEST_F(MapOffsetMonitorTest, ALargeOffsetThatHasEndedIsForgotten) {
  for (; now_ < Time(minutes(30)); now_ += seconds(1)) monitor_.add(now_, {7.0, 0.0}, 3.0);
  ASSERT_TRUE(monitor_.contradicts());
  for (; now_ < Time(minutes(120)); now_ += seconds(1)) monitor_.add(now_, {0.0, 0.0}, 1.0);
  EXPECT_FALSE(monitor_.contradicts());
}

TEST_F(MapOffsetMonitorTest, AJumpOfGnssIsNoOffset) {
  drive(Eigen::Vector2d::Zero(), minutes(5));
  EXPECT_EQ(drive({50.0, 0.0}, seconds(10)), Duration::zero());
}

}  // namespace
}  // namespace bevloc
