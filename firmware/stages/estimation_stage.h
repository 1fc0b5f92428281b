// The estimation stage: fuses odometry, GNSS and corrections into the pose that goes to the bus.
#pragma once

#include <array>
#include <atomic>
#include <functional>

#include "can/publisher/pose_publisher.h"
#include "common/published.h"
#include "drivers/clock/clock.h"
#include "firmware/health/health.h"
#include "firmware/stages/gnss_lag_watch.h"
#include "firmware/stages/match_history.h"
#include "firmware/stages/messages.h"
#include "firmware/stages/stamp_watch.h"
#include "firmware/stages/vehicle_input_stage.h"
#include "firmware/telemetry/latency_histogram.h"
#include "firmware/telemetry/pose_snapshot.h"
#include "firmware/threads/clock_gap.h"
#include "pipeline/tracker/pose_estimator.h"

namespace bevloc::firmware {

/// Number of times that the tracker answered with each TrackerUpdate.
using TrackerOutcomes = std::array<std::atomic<uint64_t>, kTrackerUpdates>;

/// Totals since start and the current state, readable from any thread.
struct EstimationCounters {
  std::atomic<uint64_t> ticks{0};  ///< calls of tick()
  TrackerOutcomes odometry{};      ///< by TrackerUpdate, like the next two
  TrackerOutcomes gnss{};
  TrackerOutcomes corrections{};
  std::atomic<uint64_t> clock_gaps{0};
  std::atomic<HealthState> state{HealthState::kInit};
  std::atomic<uint32_t> why{0};  ///< bits of a WhyMask
  /// The state LOST lasts one bus cycle. Threads that look less often learn of a loss from the
  /// next two members.
  std::atomic<uint64_t> lost{0};      ///< how often the pose was lost
  std::atomic<uint32_t> lost_why{0};  ///< reasons of the latest loss: bits of a WhyMask
  /// When the pose stopped being valid. It is Time::max() while the pose is valid, or if no pose
  /// was valid yet.
  std::atomic<Time> invalid_since{Time::max()};
  /// Offset of the cameras' time stamps against odometry, or 0 while it is tolerated
  /// (StampMonitor).
  std::atomic<int> stamp_offset_ms{0};
  std::atomic<int> gnss_lag_ms{0};  ///< age of GNSS; 0 while it is tolerated (GnssLagWatch)
  /// GNSS minus map, east and north, or 0 while they agree (MapOffsetMonitor).
  std::array<std::atomic<int>, 2> map_offset_cm{};
  /// The cameras that the latest frameset used, a CameraMask.
  std::atomic<unsigned> cameras{0};
  Published<PoseSnapshot> pose;  ///< the pose of the latest tick()
  std::atomic<can::TimeSource> time_source{can::TimeSource::kFreeRunning};
  /// Time from a frameset until the first valid pose with its correction is sent.
  LatencyHistogram latency;
};

/// A function that is called after a valid pose with a new correction was sent. `frame_time` is the
/// time of the frameset that the correction came from.
using CorrectionObserver = std::function<void(Time frame_time)>;

/// A function that is called with each report that went to the bus, except the sign-off. The status
/// is the one that was sent.
using ReportObserver = std::function<void(const can::PoseReport& report)>;

/// Thread-bound: called from the CAN-out thread, except note_clock(). counters() is readable from
/// any thread.
class EstimationStage {
 public:
  /// `publisher` and the queues must outlive the stage.
  EstimationStage(const TrackerParameters& tracker, const HealthLimits& limits, uint16_t map_id,
                  can::PosePublisher& publisher, VehicleQueue& samples, VisionQueue& reports,
                  PredictionQueue& predictions);

  void observe_corrections(CorrectionObserver observer);
  void observe_reports(ReportObserver observer);

  /// Makes the stage report what is wrong with the vehicle's messages. `input` must outlive the
  /// stage.
  void watch(const VehicleInputStage& input) { vehicle_input_ = &input; }

  /// Sets what the status tells about the clock from now on, until the next gap. `gaps` is
  /// EstimationCounters::clock_gaps from before the clock was read. If there was a gap since, the
  /// note has no effect. Thread-bound: called from the supervising thread.
  void note_clock(const can::ClockReport& clock, uint64_t gaps) { clock_.store({clock, gaps}); }

  /// Takes all queued samples and reports, then publishes the pose predicted to the time at which
  /// it began. If the thread stood still or the machine was suspended meanwhile, it sends LOST,
  /// because the pose is too old. After a gap between two calls (ClockGapDetector) it forgets the
  /// pose and what is queued, because the vehicle may be elsewhere, and reports LOST with
  /// Why::kClockGap. The clock counts as free-running until the next note_clock(), because a
  /// suspension changes the offset to UTC. Call it once per bus cycle.
  void tick(const drivers::Clock& clock);

  /// Publishes the state LOST without a pose, so that consumers need not wait for a timeout. Call
  /// it after the last tick().
  void sign_off(Time now);

  const EstimationCounters& counters() const { return counters_; }

 private:
  /// What note_clock() was told. It holds as long as there are no further gaps.
  struct ClockNote {
    can::ClockReport clock;
    uint64_t gaps = 0;  ///< EstimationCounters::clock_gaps before the clock was read
  };

  void take_samples();
  void take_reports(Time now);
  void add_correction(const VisionReport& report);
  void note_map_offset();
  void note_clock_gap();
  void watch_gnss_lag();
  HealthInputs health_inputs(const std::optional<TrackedPose>& pose, Time now) const;
  void update_health(const std::optional<TrackedPose>& pose, Time now);
  void note_validity(Time now);
  void note_pose(const std::optional<TrackedPose>& pose);
  void publish(const std::optional<TrackedPose>& pose, Time pose_time, const drivers::Clock& clock);
  void note_sent(const can::LocalizerStatus& sent);
  void count_loss(WhyMask why);
  can::LocalizerStatus make_status() const;
  /// Returns a report that is complete except for the pose.
  can::PoseReport begin_report();

  PoseEstimator estimator_;
  Health health_;
  MatchHistory matches_;
  can::PosePublisher& publisher_;
  VehicleQueue& samples_;
  VisionQueue& reports_;
  PredictionQueue& predictions_;
  CorrectionObserver correction_observer_;
  ReportObserver report_observer_;
  const VehicleInputStage* vehicle_input_ = nullptr;

  ProtectionParameters protection_parameters_;
  /// Protection level of the latest pose: (longitudinal m, lateral m, yaw rad).
  Eigen::Vector3d protection_ = Eigen::Vector3d::Zero();
  Duration report_lifetime_;  ///< without a newer report, the latest one expires after this
  uint16_t map_id_;
  std::optional<Time> odometry_time_;
  std::optional<Time> gnss_time_;
  std::optional<Time> valid_since_;
  std::optional<VisionReport> latest_report_;
  Time latest_report_arrival_;
  Duration report_interval_{0};  ///< between the latest two reports, at most kSlowFramesets
  bool network_fault_ = false;
  Published<ClockNote> clock_;
  ClockNote clock_note_;   ///< the latest one that this thread could read from `clock_`
  bool withheld_ = false;  ///< the latest pose was valid, but was not sent
  StampWatch stamps_;
  GnssLagWatch gnss_lag_;
  ClockGapDetector clock_gaps_;
  bool clock_gap_ = false;  ///< no correction was accepted since the latest gap
  EstimationCounters counters_;
};

}  // namespace bevloc::firmware
