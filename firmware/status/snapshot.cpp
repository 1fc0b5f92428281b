#include "firmware/status/snapshot.h"

namespace bevloc::firmware {
namespace {

OutcomeCounts counts_of(const TrackerOutcomes& outcomes) {
  OutcomeCounts counts{};
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = outcomes[i];
  return counts;
}

EstimationSnapshot estimation_of(const EstimationCounters& counters) {
  return {.state = counters.state,
          .why = WhyMask::from_bits(counters.why),
          .lost = counters.lost,
          .lost_why = WhyMask::from_bits(counters.lost_why),
          .invalid_since = counters.invalid_since,
          .time_source = counters.time_source,
          .cameras = CameraMask(counters.cameras),
          .ticks = counters.ticks,
          .clock_gaps = counters.clock_gaps,
          .odometry = counts_of(counters.odometry),
          .gnss = counts_of(counters.gnss),
          .corrections = counts_of(counters.corrections),
          .pose = counters.pose.load(),
          .latency = counters.latency.counts()};
}

FramesetsSnapshot framesets_of(const VisionStage& vision) {
  const VisionCounters& counters = vision.counters();
  const SynchronyCounters& synchrony = vision.framesets().synchrony();
  return {.taken = counters.framesets,
          .skipped = vision.framesets().counters().skipped,
          .no_prior = counters.no_prior,
          .refused = counters.refused,
          .clock_gaps = vision.framesets().counters().clock_gaps,
          .off_pulse = synchrony.off_pulse,
          .network_checks = counters.checks,
          .network_fault = counters.network_fault,
          .spread = synchrony.spread,
          .spread_max = synchrony.spread_max};
}

CameraSnapshot camera_of(const Appliance& appliance, int camera) {
  const CaptureStage& capture = appliance.capture()[camera];
  const VisionCounters& vision = appliance.vision().counters();
  return {.captured = capture.captured(),
          .failures = capture.failures(),
          .driver = capture.driver_counters(),
          .synchronizer = appliance.vision().framesets().frames_of(camera),
          .unreadable = vision.unreadable[camera],
          .frozen = CameraMask(vision.frozen)[camera],
          .dark = CameraMask(vision.dark)[camera],
          .blinded = CameraMask(vision.blinded)[camera],
          .dirty = CameraMask(vision.dirty)[camera],
          .stamps_jumped = CameraMask(vision.stamps_jumped)[camera],
          .drift_ppm = appliance.vision().framesets().synchrony().drift_ppm[camera]};
}

TriggerSnapshot trigger_of(const drivers::Trigger& trigger) {
  return {.pulses = trigger.pulses().count(),
          .skipped = trigger.counters().skipped,
          .failed = trigger.counters().failed,
          .max_lateness = trigger.counters().max_lateness};
}

}  // namespace

Snapshot take_snapshot(const Appliance& appliance, const SnapshotSources& others) {
  Snapshot snapshot;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    snapshot.cameras[camera] = camera_of(appliance, camera);
  }
  snapshot.frames = appliance.frame_counts();
  snapshot.queue_drops = appliance.queue_drops();
  snapshot.framesets = framesets_of(appliance.vision());
  snapshot.vehicle_input = appliance.vehicle_input().counters();
  snapshot.authentication = appliance.vehicle_input().secoc_counters();
  if (appliance.gnss() != nullptr) snapshot.gnss = appliance.gnss()->counters();
  snapshot.estimation = estimation_of(appliance.estimation().counters());
  snapshot.bus = appliance.bus().counters();
  snapshot.bus_condition = appliance.bus().condition();
  if (others.trigger != nullptr) snapshot.trigger = trigger_of(*others.trigger);
  snapshot.recording = others.recording;
  snapshot.log_dropped = others.log_dropped;
  return snapshot;
}

}  // namespace bevloc::firmware
