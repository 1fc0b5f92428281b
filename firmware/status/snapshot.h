// All counters of a running appliance in one plain struct.
#pragma once

#include <array>
#include <optional>

#include "drivers/trigger/trigger.h"
#include "firmware/runtime/appliance.h"
#include "firmware/telemetry/latency_histogram.h"
#include "firmware/telemetry/pose_snapshot.h"

namespace bevloc::firmware {

/// What one camera delivered, and what became of it. Totals since start, as in the structs that
/// they come from.
struct CameraSnapshot {
  uint64_t captured = 0;  ///< frames that the capture stage took
  uint64_t failures = 0;  ///< starts and reads that failed
  drivers::CameraCounters driver;
  drivers::SynchronizerCounters synchronizer;
  uint64_t unreadable = 0;  ///< images of a wrong size, or damaged
  /// At the latest frameset, like the next four. If it was not matched, this and the next three are
  /// false, because nobody has judged the images.
  bool frozen = false;
  bool dark = false;
  bool blinded = false;
  bool dirty = false;
  bool stamps_jumped = false;
  double drift_ppm = 0.0;
};

struct FramesetsSnapshot {
  uint64_t taken = 0;       ///< framesets that vision took, matched or not
  uint64_t skipped = 0;     ///< skipped for a newer one
  uint64_t no_prior = 0;    ///< no prediction covered their time
  uint64_t refused = 0;     ///< too few usable images
  uint64_t clock_gaps = 0;  ///< FramesetSource::kGap
  uint64_t off_pulse = 0;
  uint64_t network_checks = 0;
  bool network_fault = false;
  Duration spread{};  ///< spread of the latest one
  Duration spread_max{};
};

/// Answers of the tracker, by TrackerUpdate.
using OutcomeCounts = std::array<uint64_t, kTrackerUpdates>;

struct EstimationSnapshot {
  HealthState state = HealthState::kInit;
  WhyMask why;
  uint64_t lost = 0;                 ///< how often the pose was lost
  WhyMask lost_why;                  ///< reasons of the latest loss
  Time invalid_since = Time::max();  ///< as in EstimationCounters
  can::TimeSource time_source = can::TimeSource::kFreeRunning;
  CameraMask cameras;  ///< cameras that the latest frameset used
  uint64_t ticks = 0;
  uint64_t clock_gaps = 0;
  OutcomeCounts odometry{};
  OutcomeCounts gnss{};
  OutcomeCounts corrections{};
  PoseSnapshot pose;
  LatencyCounts latency;
};

struct TriggerSnapshot {
  uint64_t pulses = 0;
  uint64_t skipped = 0;
  uint64_t failed = 0;
  Duration max_lateness{};
};

/// The counters of RecorderCounters. What was dropped includes the entries that the queues dropped.
struct RecordingSnapshot {
  uint64_t images = 0;
  uint64_t events = 0;
  uint64_t images_dropped = 0;
  uint64_t events_dropped = 0;
  uint64_t bytes = 0;
  uint64_t black_boxes = 0;
  bool failed = false;
};

struct Snapshot {
  std::array<CameraSnapshot, kCameraCount> cameras;
  FrameCounts frames;
  QueueDrops queue_drops;
  FramesetsSnapshot framesets;
  can::VehicleInputCounters vehicle_input;
  std::optional<can::SecocCounters> authentication;  ///< empty without authentication
  std::optional<GnssCounters> gnss;                  ///< empty if GNSS comes on the bus
  EstimationSnapshot estimation;
  can::BusCounters bus;
  can::BusCondition bus_condition;
  std::optional<TriggerSnapshot> trigger;
  std::optional<RecordingSnapshot> recording;  ///< empty without a recording
  uint64_t log_dropped = 0;                    ///< lines of the log that were not written
};

/// The sources of counters that are not a part of the appliance.
struct SnapshotSources {
  const drivers::Trigger* trigger = nullptr;     ///< null without one
  std::optional<RecordingSnapshot> recording{};  ///< empty without a recording
  uint64_t log_dropped = 0;
};

/// Reads all counters while the appliance runs. Waits for no thread, so values that change together
/// may differ by one step. Thread-safe.
Snapshot take_snapshot(const Appliance& appliance, const SnapshotSources& others);

}  // namespace bevloc::firmware
