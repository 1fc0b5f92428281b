// The check of odometry on simulated drives: it refuses nothing of a healthy vehicle, and slipping
// wheels while they slip.
#include <vector>

#include <gtest/gtest.h>

#include "can/messages/odometry_check.h"
#include "sim/faults/odometry_faults.h"
#include "sim/world/world_generator.h"

namespace bevloc::evaluation {
namespace {

constexpr double kTrack_m = 1.6;

/// Returns the numbers of the refused readings.
std::vector<size_t> refused_readings(const sim::OdometrySimulator& odometry,
                                     const std::vector<sim::Fault>& faults) {
  can::OdometryCheck check{can::OdometryLimits{}};
  std::vector<size_t> refused;
  for (size_t i = 0; i < odometry.count(); ++i) {
    const double time_s = static_cast<double>(i) * sim::OdometrySimulator::kPeriod_s;
    std::vector<sim::Fault> active;
    for (const sim::Fault& fault : faults) {
      if (fault.is_active(time_s)) active.push_back(fault);
    }
    const auto reading = sim::reading_with_faults(odometry, i, kTrack_m, active);
    if (!reading) continue;
    const auto verdict = check.judge({Time(from_seconds(100.0 + time_s)), reading->left_mps,
                                      reading->right_mps, reading->yaw_rate_radps});
    if (verdict != can::OdometryVerdict::kPlausible) refused.push_back(i);
  }
  return refused;
}

class OdometryPlausibility : public testing::TestWithParam<uint64_t> {
 protected:
  const sim::World world_ = sim::generate_world(GetParam());
  const sim::Drive drive_{world_, GetParam() + 1, 120.0};
  const sim::OdometrySimulator odometry_{drive_, GetParam() + 2};
};

INSTANTIATE_TEST_SUITE_P(Seeds, OdometryPlausibility, testing::Range<uint64_t>(2000, 2020));

TEST_P(OdometryPlausibility, NothingOfAHealthyDriveIsRefused) {
  EXPECT_TRUE(refused_readings(odometry_, {}).empty());
}

TEST_P(OdometryPlausibility, SlippingWheelsAreRefusedWhileTheySlip) {
  size_t slips = 0;
  for (double from_s = 5.0; from_s < 110.0; from_s += 10.0) {
    const auto before = odometry_.reading(static_cast<size_t>(from_s / 0.02));
    if (before.speed_mps < 8.0) continue;
    for (const sim::FaultKind kind :
         {sim::FaultKind::kOdometrySlip, sim::FaultKind::kOdometryLock}) {
      const double factor = kind == sim::FaultKind::kOdometrySlip ? 1.3 : 0.3;
      const sim::Fault fault{
          .kind = kind, .from_s = from_s, .until_s = from_s + 1.5, .amounts = {.factor = factor}};
      const auto refused = refused_readings(odometry_, {fault});
      EXPECT_GE(refused.size(), 65u) << "of 75, from " << from_s << " s, factor " << factor;
      EXPECT_LE(refused.size(), 75u + 125u) << "at most 2.5 s after the slip";
      ++slips;
    }
  }
  EXPECT_GT(slips, 0u);
}

}  // namespace
}  // namespace bevloc::evaluation
