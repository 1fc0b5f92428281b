#include "can/messages/vehicle_input.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "can/e2e/e2e_p02.h"
#include "can/messages/vehicle_encoder.h"
#include "tests/can/messages/tracking_report.h"

namespace bevloc::can {
namespace {

using std::chrono::milliseconds;
using test::kNan;
using test::kNow;
using test::kOrigin;

constexpr double kTrack_m = 1.6;

class VehicleInputTest : public testing::Test {
 protected:
  template <typename Frames>
  VehicleSamples feed(const Frames& frames, Time now) {
    VehicleSamples last;
    for (const Frame& frame : frames) last = input_.accept({frame, now});
    return last;
  }

  OdometrySample motion() const { return {.speed_mps = 12.3, .yaw_rate_radps = 0.2}; }
  GnssSample fix() const {
    return {.east_m = 321.0,
            .north_m = -45.6,
            .sigma_east_m = 1.234,
            .sigma_north_m = 0.8,
            .yaw = GnssSample::Yaw{2.5, 0.02}};
  }

  VehicleEncoder encoder_{BaseIds{}, kOrigin, kTrack_m};
  VehicleInput input_{BaseIds{}, kOrigin, kTrack_m};
};

TEST_F(VehicleInputTest, OdometryRoundTrips) {
  const auto frames = encoder_.odometry(motion());
  EXPECT_FALSE(input_.accept({frames[0], kNow}));
  const auto odometry = input_.accept({frames[1], kNow + milliseconds(1)}).odometry;
  ASSERT_TRUE(odometry);
  EXPECT_NEAR(odometry->speed_mps, 12.3, 0.0013);
  EXPECT_NEAR(odometry->yaw_rate_radps, 0.2, radians(0.0026));
  EXPECT_EQ(odometry->time, kNow) << "the time of the first frame";
}

TEST_F(VehicleInputTest, TheOuterWheelIsFasterInABend) {
  const auto frames = encoder_.odometry(motion());
  const double left_mps = *decode(frames[0], veh_wheel_speed::kRearLeft);
  const double right_mps = *decode(frames[0], veh_wheel_speed::kRearRight);
  EXPECT_NEAR(right_mps - left_mps, 0.2 * kTrack_m, 0.003);
}

TEST_F(VehicleInputTest, GnssRoundTrips) {
  const auto sample = feed(encoder_.gnss(fix()), kNow).gnss;
  ASSERT_TRUE(sample);
  const GnssSample& gnss = *sample;
  EXPECT_NEAR(gnss.east_m, 321.0, 0.01);
  EXPECT_NEAR(gnss.north_m, -45.6, 0.01);
  EXPECT_NEAR(gnss.sigma_east_m, 1.24, 1e-9) << "rounded up";
  EXPECT_NEAR(gnss.sigma_north_m, 0.8, 1e-9);
  ASSERT_TRUE(gnss.yaw);
  EXPECT_NEAR(gnss.yaw->yaw_rad, 2.5, radians(0.0051));
  EXPECT_NEAR(gnss.yaw->sigma_rad, 0.02, radians(0.01));
  EXPECT_EQ(gnss.time, kNow);
}

TEST_F(VehicleInputTest, AGnssFixWithoutHeadingIsStillAFix) {
  GnssSample standing = fix();
  standing.yaw.reset();
  const auto sample = feed(encoder_.gnss(standing), kNow).gnss;
  ASSERT_TRUE(sample);
  EXPECT_FALSE(sample->yaw);
}

TEST_F(VehicleInputTest, AZeroSigmaMeansOneStep) {
  GnssSample exact = fix();
  exact.sigma_east_m = exact.sigma_north_m = 0.0;
  exact.yaw->sigma_rad = 0.0;
  const auto sample = feed(encoder_.gnss(exact), kNow).gnss;
  ASSERT_TRUE(sample);
  EXPECT_DOUBLE_EQ(sample->sigma_east_m, 0.01);
  EXPECT_DOUBLE_EQ(sample->yaw->sigma_rad, radians(0.01));
}

TEST_F(VehicleInputTest, SnaGivesNoSample) {
  for (const OdometrySample& bad : {OdometrySample{{}, kNan, 0.1}, OdometrySample{{}, 3.0, kNan}}) {
    EXPECT_FALSE(feed(encoder_.odometry(bad), kNow));
  }
  for (double GnssSample::*member : {&GnssSample::east_m, &GnssSample::north_m,
                                     &GnssSample::sigma_east_m, &GnssSample::sigma_north_m}) {
    GnssSample bad = fix();
    bad.*member = kNan;
    EXPECT_FALSE(feed(encoder_.gnss(bad), kNow));
  }
  EXPECT_EQ(input_.counters().not_available, 6u);
  EXPECT_EQ(input_.counters().odometry_samples + input_.counters().gnss_samples, 0u);
}

TEST_F(VehicleInputTest, FramesOfDifferentEpochsAreNotPaired) {
  const auto first = encoder_.odometry(motion());
  const auto second = encoder_.odometry(motion());
  EXPECT_FALSE(input_.accept({first[0], kNow}));
  EXPECT_FALSE(input_.accept({second[1], kNow}));
  EXPECT_TRUE(input_.accept({second[0], kNow}).odometry);
  EXPECT_EQ(input_.counters().incomplete, 1u);
}

TEST_F(VehicleInputTest, FramesOfARepeatedEpochAreNotPaired) {
  const auto first = encoder_.odometry(motion());
  for (int i = 0; i < 15; ++i) encoder_.odometry(motion());
  const auto a_round_later = encoder_.odometry(motion());
  ASSERT_EQ(extract_raw(first[0], kEpoch), extract_raw(a_round_later[0], kEpoch));
  input_.accept({first[0], kNow});
  EXPECT_FALSE(input_.accept({a_round_later[1], kNow + milliseconds(160)}));
}

TEST_F(VehicleInputTest, BadFramesAreCountedAndIgnored) {
  auto frames = encoder_.odometry(motion());
  frames[1].data[3] ^= 0x04;
  EXPECT_FALSE(feed(frames, kNow));
  EXPECT_EQ(input_.counters().wrong_crc, 1u);

  frames = encoder_.odometry(motion());
  frames[1].length = 3;
  EXPECT_FALSE(feed(frames, kNow));
  EXPECT_EQ(input_.counters().wrong_length, 1u);

  EXPECT_FALSE(input_.accept({frames[0], kNow}));
  EXPECT_EQ(input_.counters().repeated, 1u);

  Frame masquerade = encoder_.odometry(motion())[1];
  masquerade.id = veh_wheel_speed::kMessage.id(BaseIds{});
  masquerade.length = veh_wheel_speed::kMessage.length;
  EXPECT_FALSE(input_.accept({masquerade, kNow}));
  EXPECT_EQ(input_.counters().wrong_crc, 2u);

  input_.accept({{.id = 0x123, .length = 8}, kNow});
  EXPECT_EQ(input_.counters().foreign, 1u);
  EXPECT_EQ(input_.counters().odometry_samples, 0u);
}

TEST_F(VehicleInputTest, AfterALossTheNextSampleIsUsedAndTheLossCounted) {
  feed(encoder_.odometry(motion()), kNow);
  encoder_.odometry(motion());
  EXPECT_TRUE(feed(encoder_.odometry(motion()), kNow + milliseconds(20)).odometry);
  EXPECT_EQ(input_.counters().lost, 2u) << "one frame of each message";
  EXPECT_EQ(input_.counters().odometry_samples, 2u);
}

TEST_F(VehicleInputTest, UsesTheConfiguredBaseIds) {
  const BaseIds base{.localizer = 0x600, .vehicle = 0x210};
  VehicleEncoder encoder(base, kOrigin, kTrack_m);
  VehicleInput input(base, kOrigin, kTrack_m);
  for (const Frame& frame : encoder.odometry(motion())) input.accept({frame, kNow});
  EXPECT_EQ(input.counters().odometry_samples, 1u);
  EXPECT_EQ(VehicleInput::accepted_ids(base, false),
            (std::vector<uint32_t>{0x210, 0x211, 0x212, 0x213, 0x214}));
}

void expect_finite(const VehicleSamples& samples) {
  if (const auto& odometry = samples.odometry) {
    ASSERT_TRUE(std::isfinite(odometry->speed_mps) && std::isfinite(odometry->yaw_rate_radps));
  }
  if (const auto& gnss = samples.gnss) {
    ASSERT_TRUE(std::isfinite(gnss->east_m) && std::isfinite(gnss->north_m));
    ASSERT_TRUE(gnss->sigma_east_m > 0.0 && gnss->sigma_north_m > 0.0);
    ASSERT_TRUE(!gnss->yaw || (std::isfinite(gnss->yaw->yaw_rad) && gnss->yaw->sigma_rad > 0.0));
  }
}

/// Most of the random frames have a valid protection and the next counter of their message, so that
/// their content reaches the decoder.
TEST_F(VehicleInputTest, RandomFramesNeverGiveASampleThatIsNotFinite) {
  std::mt19937 random(20240607);
  const Message* const inputs[] = {&veh_wheel_speed::kMessage, &veh_yaw_rate::kMessage,
                                   &veh_gnss_latitude::kMessage, &veh_gnss_longitude::kMessage,
                                   &veh_gnss_heading::kMessage};
  uint8_t counters[std::size(inputs)] = {};
  for (int i = 0; i < 100000; ++i) {
    const size_t input = random() % std::size(inputs);
    const Message& message = *inputs[input];
    Frame frame{.id = 0x3FE + static_cast<uint32_t>(random() % 9),
                .length = static_cast<uint8_t>(random() % 9)};
    for (uint8_t& byte : frame.data) byte = static_cast<uint8_t>(random());
    if (random() % 10 != 0) {
      frame.id = message.id(BaseIds{});
      frame.length = message.length;
      frame.data[1] &= 0x1F;  // two epochs, so that they often match
      protect_p02(frame, static_cast<uint8_t>(message.data_id), ++counters[input] & 0x0F);
    }
    expect_finite(input_.accept({frame, kNow + milliseconds(i)}));
    if (HasFatalFailure()) return;
  }
  const VehicleInputCounters counted = input_.counters();
  EXPECT_GT(counted.contradicting_wheels, 1000u) << "random wheels reach the check";
  EXPECT_GT(counted.odometry_samples, 0u);
  EXPECT_GT(counted.gnss_samples, 10u);
  EXPECT_GT(counted.wrong_crc, 300u);
  EXPECT_GT(input_.counters().wrong_length, 1000u);
}

}  // namespace
}  // namespace bevloc::can
