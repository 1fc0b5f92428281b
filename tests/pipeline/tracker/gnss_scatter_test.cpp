#include "pipeline/tracker/gnss_scatter.h"

#include <gtest/gtest.h>

#include "tests/pipeline/tracker/simulated_vehicle.h"

namespace bevloc {
namespace {

/// A vehicle with 50 samples of odometry and 10 of GNSS in a second.
class GnssScatterTest : public testing::Test {
 protected:
  /// Drives for `duration_s`, with what `change` makes of each GNSS sample.
  void drive(double duration_s, const std::function<void(GnssSample&)>& change) {
    const double end_s = time_s_ + duration_s;
    while (time_s_ < end_s) {
      time_s_ += kOdometryStep_s;
      const Se2 truth = vehicle_.drive_to(time_s_);
      scatter_.add(vehicle_.odometry(time_s_));
      if (++steps_ % 5 != 0) continue;
      sample_ = vehicle_.gnss();
      change(sample_);
      scatter_.add(sample_, truth.yaw_rad);
    }
  }
  double seen_sigma_m() const { return scatter_.with_seen_sigma(sample_).sigma_east_m; }
  double seen_yaw_sigma_rad() const { return scatter_.with_seen_sigma(sample_).yaw->sigma_rad; }

  SimulatedVehicle vehicle_{typical_errors(), 1};
  GnssScatter scatter_{MeasurementModel(), 40.0};
  GnssSample sample_;
  double time_s_ = 0.0;
  int steps_ = 0;
};

void change_nothing(GnssSample&) {}

void claim_a_third(GnssSample& sample) {
  sample.sigma_east_m /= 3.0;
  sample.sigma_north_m /= 3.0;
}

/// White noise of a standard deviation of `sigma_m` on each axis.
class Noise {
 public:
  explicit Noise(double sigma_m) : normal_(0.0, sigma_m) {}
  void operator()(GnssSample& sample) {
    sample.east_m += normal_(random_);
    sample.north_m += normal_(random_);
  }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

TEST_F(GnssScatterTest, ARightSigmaStays) {
  Noise noise(0.25);
  drive(60.0, [&](GnssSample& sample) {
    noise(sample);
    EXPECT_FALSE(scatter_.contradicts());
    EXPECT_LT(seen_sigma_m(), 1.3 * sample.sigma_east_m);
  });
}

TEST_F(GnssScatterTest, FindsNoiseThatTheSigmaDoesNotTell) {
  drive(10.0, claim_a_third);
  EXPECT_FALSE(scatter_.contradicts()) << "an error that changes slowly is no noise";
  Noise noise(0.5);
  drive(3.0, [&](GnssSample& sample) {
    noise(sample);
    claim_a_third(sample);
  });
  EXPECT_TRUE(scatter_.contradicts());
  EXPECT_GT(seen_sigma_m(), 1.0);
  drive(10.0, change_nothing);
  EXPECT_FALSE(scatter_.contradicts());
  EXPECT_DOUBLE_EQ(seen_sigma_m(), sample_.sigma_east_m);
}

TEST_F(GnssScatterTest, FindsNoiseOfTheHeading) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, radians(1.5));
  drive(5.0, [&](GnssSample& sample) { sample.yaw->yaw_rad += noise(random); });
  EXPECT_TRUE(scatter_.contradicts());
  EXPECT_GT(seen_yaw_sigma_rad(), radians(2.0));
  EXPECT_DOUBLE_EQ(seen_sigma_m(), sample_.sigma_east_m);
}

TEST_F(GnssScatterTest, AJumpIsNoNoise) {
  drive(10.0, change_nothing);
  drive(10.0, [&](GnssSample& sample) {
    sample.north_m += 20.0;
    EXPECT_LT(seen_sigma_m(), 1.3 * sample.sigma_east_m);
  });
}

TEST_F(GnssScatterTest, ADriftIsNoNoise) {
  const double begin_s = time_s_;
  drive(30.0, [&](GnssSample& sample) {
    sample.north_m += 3.0 * (time_s_ - begin_s);
    EXPECT_LT(seen_sigma_m(), 1.3 * sample.sigma_east_m);
  });
}

TEST_F(GnssScatterTest, ComparesNothingAcrossAPause) {
  drive(5.0, change_nothing);
  for (int i = 0; i < 30; ++i) {
    time_s_ += 5.0;
    vehicle_.drive_to(time_s_);
    drive(0.2, change_nothing);
    EXPECT_DOUBLE_EQ(seen_sigma_m(), sample_.sigma_east_m);
  }
}

}  // namespace
}  // namespace bevloc
