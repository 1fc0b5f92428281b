// Keeps the pose: odometry, GNSS and corrections in; predictions and CAN frames out.
#pragma once

#include <atomic>
#include <functional>

#include "can/pose_publisher.h"
#include "firmware/gnss_monitor.h"
#include "firmware/health.h"
#include "firmware/messages.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

/// Totals since start, and what a display may show; readable from any thread.
struct EstimationCounters {
  std::atomic<uint64_t> ticks{0};
  std::atomic<uint64_t> accepted{0};
  std::atomic<uint64_t> refused{0};
  std::atomic<uint64_t> without_evidence{0};
  std::atomic<State> state{State::kInit};
  std::atomic<uint16_t> why{0};
  std::atomic<unsigned> cameras{0};  ///< bit mask of the latest frameset
};

/// Called when a pose that rests on the frameset of this time has been handed to the bus for the
/// first time.
using CorrectionObserver = std::function<void(Time frame_time)>;

/// Thread: one, the CAN-out thread, which calls tick() on the bus cycle; counters() from any.
class EstimationStage {
 public:
  EstimationStage(const TrackerParameters& tracker, const HealthLimits& limits, uint16_t map_id,
                  can::PosePublisher& publisher, VehicleQueue& samples, VisionQueue& reports,
                  PredictionQueue& predictions);

  void observe_corrections(CorrectionObserver observer);

  /// Takes in everything that has arrived, then publishes the pose predicted to `now`.
  void tick(Time now);

  /// The last message: there is no pose any more, so that no consumer has to wait for a time-out.
  /// After the last tick().
  void sign_off(Time now);

  const EstimationCounters& counters() const { return counters_; }

 private:
  void take_samples();
  void watch_gnss(const GnssSample& sample);
  void take_reports(Time now);
  void weigh(const VisionReport& report);
  void update_health(const std::optional<TrackedPose>& pose, Time now);
  void publish(const std::optional<TrackedPose>& pose, Time now);
  can::LocalizerStatus make_status() const;

  Tracker tracker_;
  Health health_;
  GnssMonitor gnss_monitor_;
  can::PosePublisher& publisher_;
  VehicleQueue& samples_;
  VisionQueue& reports_;
  PredictionQueue& predictions_;
  CorrectionObserver correction_observer_;

  Duration report_lifetime_;
  uint16_t map_id_;
  std::optional<Time> odometry_time_;
  std::optional<Time> gnss_time_;
  std::optional<Time> accepted_frame_time_;
  std::optional<Time> unsent_correction_;
  std::optional<VisionReport> latest_report_;
  Time report_came_;
  int accepted_in_a_row_ = 0;
  int refused_in_a_row_ = 0;
  EstimationCounters counters_;
};

}  // namespace bevloc::firmware
