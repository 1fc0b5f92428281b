#include "drivers/frameset/rate_monitor.h"

#include <cmath>

#include <gtest/gtest.h>

#include "sim/random.h"

namespace bevloc::drivers {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr int kDrifting = 4;

/// Generates the frame times of six cameras, each with its own phase, rate and jitter.
class Cameras {
 public:
  Cameras(uint64_t seed, double jitter_s) : random_(seed), jitter_s_(jitter_s) {}

  void set_drift(int camera, double ppm) { period_s_[camera] = kPeriod_s / (1.0 + 1e-6 * ppm); }
  void lose_frames(double share) { lost_ = share; }

  /// Adds the frames with the numbers `begin` to `end` - 1.
  void run(RateMonitor& monitor, int begin, int end) {
    for (int k = begin; k < end; ++k) {
      for (int camera = 0; camera < kCameraCount; ++camera) {
        const double jitter_s = jitter_s_ * random_.uniform(-1.0, 1.0);
        const double phase_s = 0.013 * camera;
        if (random_.chance(lost_)) continue;
        monitor.add(camera, Time(from_seconds(100.0 + phase_s + k * period_s_[camera] + jitter_s)));
      }
    }
  }

 private:
  sim::Random random_;
  double jitter_s_;
  double lost_ = 0.0;
  std::array<double, kCameraCount> period_s_{kPeriod_s, kPeriod_s, kPeriod_s,
                                             kPeriod_s, kPeriod_s, kPeriod_s};
};

CameraMask drifting(const RateMonitor& monitor) {
  CameraMask mask;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    mask[camera] = monitor.drift(camera) && monitor.drift(camera)->certain();
  }
  return mask;
}

class RateMonitorTest : public testing::TestWithParam<uint64_t> {};

TEST_P(RateMonitorTest, FindsAndNamesTheCameraThatDriftsBy50Ppm) {
  for (const double ppm : {50.0, -50.0}) {
    RateMonitor monitor;
    Cameras cameras(GetParam(), 2e-4);
    cameras.set_drift(kDrifting, ppm);
    cameras.run(monitor, 0, 160);
    EXPECT_EQ(drifting(monitor), CameraMask(1U << kDrifting));
    EXPECT_NEAR(monitor.drift(kDrifting)->ppm, ppm, 4.0 * monitor.drift(kDrifting)->sigma_ppm);
  }
}

TEST_P(RateMonitorTest, JitterIsNotReportedAsDrift) {
  for (const double jitter_s : {0.0, 1e-4, 1e-3, 1e-2}) {
    RateMonitor monitor;
    Cameras cameras(GetParam(), jitter_s);
    for (int k = 0; k < 640; k += 32) {
      cameras.run(monitor, k, k + 32);
      ASSERT_TRUE(drifting(monitor).none()) << "jitter " << jitter_s << " s, frame " << k;
    }
  }
}

TEST_P(RateMonitorTest, LostFramesAreNotReportedAsDrift) {
  RateMonitor monitor;
  Cameras cameras(GetParam(), 2e-4);
  cameras.lose_frames(0.3);
  cameras.set_drift(kDrifting, 80.0);
  cameras.run(monitor, 0, 400);
  EXPECT_EQ(drifting(monitor), CameraMask(1U << kDrifting));
}

INSTANTIATE_TEST_SUITE_P(Seeds, RateMonitorTest, testing::Range<uint64_t>(0, 20));

TEST(RateMonitor, NeedsSomeFramesForAnEstimate) {
  RateMonitor monitor;
  Cameras cameras(1, 1e-5);
  cameras.set_drift(kDrifting, 500.0);
  cameras.run(monitor, 0, RateMonitor::kFewest - 1);
  for (int camera = 0; camera < kCameraCount; ++camera) EXPECT_FALSE(monitor.drift(camera));
  cameras.run(monitor, RateMonitor::kFewest - 1, 2 * RateMonitor::kFewest);
  EXPECT_TRUE(monitor.drift(kDrifting));
}

TEST(RateMonitor, NeedsThreeCameras) {
  RateMonitor monitor;
  for (int k = 0; k < RateMonitor::kWindow; ++k) {
    monitor.add(0, Time(from_seconds(k * kPeriod_s)));
    monitor.add(1, Time(from_seconds(k * kPeriod_s * 1.001)));
  }
  EXPECT_FALSE(monitor.drift(0));
  EXPECT_FALSE(monitor.drift(1));
}

TEST(RateMonitor, ForgetsTheDriftAfterAPause) {
  RateMonitor monitor;
  Cameras cameras(3, 1e-5);
  cameras.set_drift(kDrifting, 100.0);
  cameras.run(monitor, 0, RateMonitor::kWindow);
  EXPECT_EQ(drifting(monitor), CameraMask(1U << kDrifting));
  cameras.set_drift(kDrifting, 0.0);
  constexpr int kAfterPause = RateMonitor::kWindow + 1000;
  cameras.run(monitor, kAfterPause, kAfterPause + 2 * RateMonitor::kFewest);
  ASSERT_TRUE(monitor.drift(kDrifting));
  EXPECT_TRUE(drifting(monitor).none());
}

TEST(RateMonitor, FramesWithoutARateGiveNoEstimate) {
  RateMonitor monitor;
  sim::Random random(5);
  std::array<double, kCameraCount> time_s{};
  for (int k = 0; k < RateMonitor::kWindow; ++k) {
    for (int camera = 0; camera < kCameraCount; ++camera) {
      time_s[camera] += camera == kDrifting ? random.uniform(0.001, 0.5) : kPeriod_s;
      monitor.add(camera, Time(from_seconds(time_s[camera])));
    }
  }
  EXPECT_FALSE(monitor.drift(kDrifting));
  EXPECT_TRUE(monitor.drift(0));
}

}  // namespace
}  // namespace bevloc::drivers
