// An estimation stage on a mock bus, and a simulated vehicle whose samples and reports it takes.
#pragma once

#include <cmath>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "evaluation/drive/pose_reader.h"
#include "firmware/stages/estimation_stage.h"

namespace bevloc::test {

/// A vehicle that drives east at constant speed, or on a winding road. GNSS is one metre too far
/// north. The vision reports contain the truth, or an error that the test sets.
class EstimationStageTest : public testing::Test {
 protected:
  static constexpr can::GeodeticPosition kMapOrigin{49.0, 8.4};
  static constexpr double kSpeed_mps = 10.0;
  static constexpr double kNoise_mps = 0.01;

  double yaw_rate_radps(Time time) const {
    return winding_ ? 0.3 * std::sin(0.5 * to_seconds(time.time_since_epoch())) : 0.0;
  }

  double yaw_rad(double time_s) const {
    return winding_ ? 0.6 * (1.0 - std::cos(0.5 * time_s)) : 0.0;
  }

  Se2 truth_at(Time time) const {
    const double time_s = to_seconds(time.time_since_epoch());
    if (!winding_) return {kSpeed_mps * time_s, 0.0, 0.0};
    Se2 truth{0.0, 0.0, yaw_rad(time_s)};
    const int steps = 1 + static_cast<int>(time_s / 0.01);
    const double step_s = time_s / steps;
    for (int step = 0; step < steps; ++step) {
      const double yaw = yaw_rad((step + 0.5) * step_s);
      truth.x_m += kSpeed_mps * step_s * std::cos(yaw);
      truth.y_m += kSpeed_mps * step_s * std::sin(yaw);
    }
    return truth;
  }

  void run(Duration duration) {
    for (const Time end = now_ + duration; now_ < end; now_ += std::chrono::milliseconds(10)) {
      push_samples();
      const bool is_due = now_.time_since_epoch() % report_period_ == Duration::zero();
      if (vision_ && is_due) push_report(now_ - std::chrono::milliseconds(40));
      drivers::VirtualClock clock(now_);
      clock.suspend(suspended_);
      tick(clock);
    }
  }

  void tick(const drivers::Clock& clock) {
    stage_.tick(clock);
    while (const auto received = listener_->receive()) {
      if (const auto pose = reader_.accept(*received)) latest_ = pose;
    }
  }

  void push_samples() {
    using std::chrono::milliseconds;
    const Duration since_start = now_.time_since_epoch();
    if (since_start % milliseconds(20) == Duration::zero() && odometry_) {
      // Real sensors never repeat their values.
      const double noise_mps =
          since_start % milliseconds(40) == Duration::zero() ? kNoise_mps : -kNoise_mps;
      samples_.push(OdometrySample{now_, kSpeed_mps + noise_mps, yaw_rate_radps(now_)});
    }
    if (since_start % milliseconds(100) == Duration::zero()) {
      const Se2 truth = truth_at(now_);
      const GnssSample::Yaw yaw{yaw_rad(to_seconds(since_start) - gnss_heading_age_s_), 0.02};
      samples_.push(GnssSample{now_, truth.x_m, truth.y_m + gnss_north_m_, gnss_sigma_m_,
                               gnss_sigma_m_, yaw});
    }
  }

  void push_report(Time frame_time) {
    firmware::VisionReport report;
    report.frame_time = frame_time;
    report.present.set();
    report.skipped = skipped_;
    report.stamps_jumped = stamps_jumped_;
    report.had_prior = true;
    report.map_nearby = true;
    report.prior = truth_at(frame_time) * Se2{0.5, 0.4, 0.01};
    report.match.evidence = Evidence::kGood;
    report.match.score = 0.33;
    report.match.axis_score.setConstant(0.33);
    report.match.correction =
        correction_between(report.prior, truth_at(frame_time)) * vision_error_;
    report.match.covariance = Eigen::Vector3d(0.01, 0.0025, 1e-5).asDiagonal().toDenseMatrix();
    reports_.push(report);
  }

  /// Sets what the status tells about the clock, as read now.
  void note_clock(const can::ClockReport& clock) {
    stage_.note_clock(clock, stage_.counters().clock_gaps);
  }

  /// The latest prediction; the queue is empty then.
  std::optional<firmware::Prediction> take_prediction() {
    std::optional<firmware::Prediction> latest;
    while (auto next = predictions_.pop(Duration::zero())) latest = next;
    return latest;
  }

  uint64_t corrections(TrackerUpdate outcome) const {
    return stage_.counters().corrections[static_cast<size_t>(outcome)];
  }

  WhyMask why() const { return WhyMask::from_bits(stage_.counters().why); }

  can::MockWire wire_;
  std::unique_ptr<can::Bus> bus_ = wire_.connect();
  std::unique_ptr<can::Bus> listener_ = wire_.connect();
  can::PosePublisher publisher_{*bus_, {.map_origin = kMapOrigin}};
  firmware::VehicleQueue samples_{256};
  firmware::VisionQueue reports_{16};
  firmware::PredictionQueue predictions_{128};
  firmware::EstimationStage stage_{
      TrackerParameters(), firmware::HealthLimits(), 7, publisher_, samples_, reports_,
      predictions_};
  evaluation::PoseReader reader_{{}, kMapOrigin};
  Time now_{std::chrono::milliseconds(1000)};
  Duration suspended_{};  ///< how long the machine was suspended
  Se2 vision_error_;
  double gnss_north_m_ = 1.0;
  double gnss_sigma_m_ = 1.0;
  double gnss_heading_age_s_ = 0.0;
  bool winding_ = false;
  bool odometry_ = true;
  bool vision_ = true;
  Duration report_period_ = std::chrono::milliseconds(100);
  bool skipped_ = false;
  bool stamps_jumped_ = false;
  std::optional<evaluation::BusPose> latest_;
};

}  // namespace bevloc::test
