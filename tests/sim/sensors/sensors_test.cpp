#include <vector>

#include <gtest/gtest.h>

#include "sim/sensors/gnss.h"
#include "sim/sensors/odometry.h"
#include "sim/world/world_generator.h"
#include "tests/support/root_mean_square.h"

namespace bevloc::sim {
namespace {

double deviation(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  double variance = 0.0;
  for (const double v : values) variance += (v - mean) * (v - mean);
  return std::sqrt(variance / static_cast<double>(values.size()));
}

class Sensors : public testing::Test {
 protected:
  static constexpr double kDuration_s = 60.0;
  const World world_ = generate_world(2);
  const Drive drive_{world_, 2, kDuration_s};
};

TEST_F(Sensors, ReadingsAreDeterminedBySeedAndIndex) {
  const GnssSimulator gnss(drive_, 5);
  const GnssSimulator again(drive_, 5);
  const GnssSimulator other(drive_, 6);
  EXPECT_EQ(gnss.reading(77).position_m, again.reading(77).position_m);
  EXPECT_NE(gnss.reading(77).position_m, other.reading(77).position_m);
  EXPECT_DOUBLE_EQ(gnss.reading(77).time_s, 7.7);
  EXPECT_GE(gnss.count(), 600U);
  const OdometrySimulator odometry(drive_, 5);
  EXPECT_EQ(odometry.reading(100).speed_mps, OdometrySimulator(drive_, 5).reading(100).speed_mps);
  EXPECT_DOUBLE_EQ(odometry.reading(100).time_s, 2.0);
  EXPECT_GE(odometry.count(), 3000U);
}

TEST_F(Sensors, GnssErrorsHaveTheDocumentedSize) {
  std::vector<double> position;
  std::vector<double> heading;
  std::vector<double> white;
  double claimed_position = 0.0;
  double claimed_heading = 0.0;
  for (uint64_t seed = 0; seed < 300; ++seed) {
    const GnssSimulator gnss(drive_, seed);
    const auto error_at = [&](size_t index) -> Eigen::Vector2d {
      const GnssReading reading = gnss.reading(index);
      return reading.position_m - drive_.at(reading.time_s).map_from_vehicle.translation();
    };
    for (const size_t index : {size_t{0}, size_t{500}}) {
      const Eigen::Vector2d error = error_at(index);
      position.push_back(error.x());
      position.push_back(error.y());
      const GnssReading reading = gnss.reading(index);
      heading.push_back(
          wrap_angle(reading.heading_rad - drive_.at(reading.time_s).map_from_vehicle.yaw_rad));
      claimed_position = reading.position_sigma_m;
      claimed_heading = reading.heading_sigma_rad;
    }
    white.push_back((error_at(101) - error_at(100)).x());
  }
  EXPECT_NEAR(test::root_mean_square(position), std::hypot(1.0, 0.25), 0.1);
  EXPECT_NEAR(degrees(test::root_mean_square(heading)), std::hypot(1.0, 0.3), 0.1);
  // Consecutive readings differ by the white noise and a small drift.
  EXPECT_NEAR(deviation(white), std::hypot(0.25 * std::sqrt(2.0), 0.07), 0.05);
  EXPECT_NEAR(claimed_position, std::hypot(1.0, 0.25), 1e-9);
  EXPECT_NEAR(degrees(claimed_heading), std::hypot(1.0, 0.3), 1e-9);
}

TEST_F(Sensors, OdometryErrorsHaveTheDocumentedSize) {
  std::vector<double> scales;
  std::vector<double> biases;
  std::vector<double> speed_noise;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    const OdometrySimulator odometry(drive_, seed);
    scales.push_back(odometry.speed_scale() - 1.0);
    double bias = 0.0;
    for (size_t i = 0; i < 400; ++i) {
      const OdometryReading reading = odometry.reading(i);
      const Drive::State truth = drive_.at(reading.time_s);
      bias += (reading.yaw_rate_radps - truth.yaw_rate_radps) / 400.0;
      speed_noise.push_back(reading.speed_mps - odometry.speed_scale() * truth.speed_mps);
    }
    biases.push_back(bias);
  }
  EXPECT_NEAR(deviation(scales), 0.01, 0.002);
  EXPECT_NEAR(degrees(deviation(biases)), 0.1, 0.02);
  EXPECT_NEAR(deviation(speed_noise), 0.03, 0.001);
}

}  // namespace
}  // namespace bevloc::sim
