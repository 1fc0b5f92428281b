#include "firmware/status/metrics.h"

#include <map>
#include <sstream>
#include <vector>

#include <prometheus/text_serializer.h>

#include "common/version.h"

namespace bevloc::firmware {
namespace {

using Labels = std::vector<prometheus::ClientMetric::Label>;

/// Collects samples. The samples of one name form a family.
class Families {
 public:
  void count(const char* name, const char* help, uint64_t value, Labels labels = {}) {
    prometheus::ClientMetric& sample = add(name, help, prometheus::MetricType::Counter, labels);
    sample.counter.value = static_cast<double>(value);
  }
  void count_seconds(const char* name, const char* help, double value_s) {
    add(name, help, prometheus::MetricType::Counter, {}).counter.value = value_s;
  }
  void gauge(const char* name, const char* help, double value, Labels labels = {}) {
    add(name, help, prometheus::MetricType::Gauge, labels).gauge.value = value;
  }
  void latency(const char* name, const char* help, const LatencyCounts& counts) {
    auto& histogram = add(name, help, prometheus::MetricType::Histogram, {}).histogram;
    uint64_t below = 0;
    for (size_t range = 0; range < LatencyCounts::kUpper_ms.size(); ++range) {
      below += counts.in_range[range];
      histogram.bucket.push_back({below, LatencyCounts::kUpper_ms[range] / 1e3});
    }
    histogram.sample_count = counts.total();
    histogram.sample_sum = to_seconds(counts.sum);
  }

  std::string text() const {
    std::ostringstream text;
    prometheus::TextSerializer().Serialize(text, families_);
    return text.str();
  }

 private:
  prometheus::ClientMetric& add(const char* name, const char* help, prometheus::MetricType type,
                                const Labels& labels) {
    const auto [place, is_new] = places_.try_emplace(name, families_.size());
    if (is_new) families_.push_back({name, help, type, {}});
    prometheus::ClientMetric& sample = families_[place->second].metric.emplace_back();
    sample.label = labels;
    return sample;
  }

  std::vector<prometheus::MetricFamily> families_;
  std::map<std::string, size_t> places_;
};

void add_state(Families& families, const Telemetry& telemetry) {
  const EstimationSnapshot& estimation = telemetry.snapshot.estimation;
  const bool running = telemetry.phase == Phase::kRunning;
  for (int i = 0; i <= static_cast<int>(HealthState::kFault); ++i) {
    const auto state = static_cast<HealthState>(i);
    families.gauge("bevloc_state", "1 for the state that holds, 0 for the others",
                   running && estimation.state == state ? 1 : 0, {{"state", to_string(state)}});
  }
  for (int bit = 0; bit < kWhyCount; ++bit) {
    const auto reason = static_cast<Why>(1u << bit);
    families.gauge("bevloc_why", "1 for each reason why the state is not better",
                   estimation.why.has(reason) ? 1 : 0, {{"reason", words_of(reason)}});
  }
  families.count("bevloc_lost_total", "How often the pose was lost", estimation.lost);
  families.gauge("bevloc_standby", "1 while the ignition is off",
                 telemetry.phase == Phase::kStandby ? 1 : 0);
  families.gauge("bevloc_time_source",
                 "What keeps the clock, as LOC_Status tells it: 0 nothing, 1 PTP, 2 GNSS, 3 NTP",
                 static_cast<double>(estimation.time_source));
  families.count("bevloc_clock_gaps_total",
                 "Suspensions and stops of the process that were noticed", estimation.clock_gaps);
  families.count("bevloc_cycles_total", "Bus cycles in which the thread CAN out did its work",
                 estimation.ticks);
}

void add_pose(Families& families, const Telemetry& telemetry, Duration age) {
  const EstimationSnapshot& estimation = telemetry.snapshot.estimation;
  const PoseSnapshot& pose = estimation.pose;
  families.gauge("bevloc_pose_valid", "1 while consumers may use the pose",
                 pose_is_valid(telemetry, age) ? 1 : 0);
  families.latency("bevloc_latency_seconds",
                   "From the time of a frameset until the first valid pose with its correction",
                   estimation.latency);
  if (!pose.known) return;
  constexpr std::array<const char*, 2> kAxes{"longitudinal", "lateral"};
  for (size_t axis = 0; axis < kAxes.size(); ++axis) {
    families.gauge("bevloc_sigma_meters", "One standard deviation of the pose", pose.sigma[axis],
                   {{"axis", kAxes[axis]}});
    families.gauge("bevloc_protection_level_meters", "Protection level of the pose",
                   pose.protection_level[axis], {{"axis", kAxes[axis]}});
  }
  families.gauge("bevloc_sigma_yaw_radians", "One standard deviation of the yaw", pose.sigma[2]);
  families.gauge("bevloc_protection_level_yaw_radians", "Protection level of the yaw",
                 pose.protection_level[2]);
  families.gauge("bevloc_speed_meters_per_second", "Speed of the vehicle", pose.speed_mps);
}

void add_camera(Families& families, const Telemetry& telemetry, int index) {
  const CameraSnapshot& camera = telemetry.snapshot.cameras[index];
  const std::string name(kCameraNames[index]);
  const auto count = [&](const char* metric, const char* help, uint64_t value) {
    families.count(metric, help, value, {{"camera", name}});
  };
  const auto lost = [&](const char* reason, uint64_t value) {
    families.count("bevloc_camera_frames_lost_total", "Frames that the driver did not deliver",
                   value, {{"camera", name}, {"reason", reason}});
  };
  const auto dropped = [&](const char* reason, uint64_t value) {
    families.count("bevloc_camera_frames_dropped_total", "Frames that the synchronizer refused",
                   value, {{"camera", name}, {"reason", reason}});
  };
  const auto fault = [&](const char* kind, bool present) {
    families.gauge("bevloc_camera_view_fault", "1 for a fault of the camera's view or stamps",
                   present ? 1 : 0, {{"camera", name}, {"fault", kind}});
  };
  count("bevloc_camera_frames_captured_total", "Frames that the camera delivered", camera.captured);
  count("bevloc_camera_failures_total", "Failed starts and reads of the camera", camera.failures);
  count("bevloc_camera_images_unreadable_total", "Images that are damaged or have a wrong size",
        camera.unreadable);
  count("bevloc_camera_framesets_missed_total", "Framesets that were emitted without the camera",
        camera.synchronizer.missing);
  count("bevloc_camera_framesets_waited_total",
        "Framesets among these that waited for the camera in vain", camera.synchronizer.waited_for);
  families.gauge("bevloc_camera_used", "1 if the latest frameset used the camera",
                 telemetry.snapshot.estimation.cameras[index] ? 1 : 0, {{"camera", name}});
  families.gauge("bevloc_camera_drift_ppm", "How much faster the camera runs than the median one",
                 camera.drift_ppm, {{"camera", name}});
  lost("no_buffer", camera.driver.no_buffer);
  lost("overrun", camera.driver.overrun);
  lost("lost", camera.driver.lost);
  lost("damaged", camera.driver.damaged);
  dropped("duplicate", camera.synchronizer.duplicate);
  dropped("out_of_order", camera.synchronizer.out_of_order);
  dropped("late", camera.synchronizer.late);
  dropped("future", camera.synchronizer.future);
  dropped("overflow", camera.synchronizer.overflow);
  dropped("unmatched", camera.synchronizer.unmatched);
  fault("frozen", camera.frozen);
  fault("dark", camera.dark);
  fault("blinded", camera.blinded);
  fault("dirty", camera.dirty);
  fault("stamps_jumped", camera.stamps_jumped);
  fault("out_of_place", telemetry.view.calibration_fault[index]);
}

void add_framesets(Families& families, const Telemetry& telemetry) {
  const FramesetsSnapshot& framesets = telemetry.snapshot.framesets;
  families.count("bevloc_framesets_total", "Framesets that vision took", framesets.taken);
  families.count("bevloc_framesets_skipped_total", "Framesets dropped for a newer one",
                 framesets.skipped);
  families.count("bevloc_framesets_without_prior_total", "Framesets without a predicted pose",
                 framesets.no_prior);
  families.count("bevloc_framesets_refused_total", "Framesets with too few usable images",
                 framesets.refused);
  families.count("bevloc_framesets_off_pulse_total", "Framesets without a pulse of the trigger",
                 framesets.off_pulse);
  families.gauge("bevloc_frameset_rate_hertz", "Framesets per second", telemetry.view.rate_hz);
  families.gauge("bevloc_frameset_spread_seconds", "Spread of the latest frameset",
                 to_seconds(framesets.spread));
  families.count("bevloc_frames_used_total", "Frames in framesets that vision took",
                 telemetry.snapshot.frames.used);
  families.count("bevloc_frames_displaced_total",
                 "Frames that newer frames pushed out of the queue",
                 telemetry.snapshot.frames.displaced);
  families.count("bevloc_network_checks_total", "Checks of network and solvers",
                 framesets.network_checks);
  families.gauge("bevloc_network_fault", "1 after a failed check", framesets.network_fault ? 1 : 0);
}

void add_queues(Families& families, const QueueDrops& drops) {
  const auto dropped = [&](const char* queue, uint64_t value) {
    families.count("bevloc_queue_dropped_total",
                   "Entries that newer ones pushed out of a queue between the stages", value,
                   {{"queue", queue}});
  };
  dropped("samples", drops.samples);
  dropped("reports", drops.reports);
  dropped("predictions", drops.predictions);
}

void add_tracker(Families& families, const char* input, const OutcomeCounts& outcomes) {
  for (size_t i = 0; i < outcomes.size(); ++i) {
    families.count(
        "bevloc_tracker_measurements_total", "What the tracker did with a measurement", outcomes[i],
        {{"input", input}, {"result", std::string(name_of(static_cast<TrackerUpdate>(i)))}});
  }
}

void add_vehicle(Families& families, const Snapshot& snapshot) {
  const can::VehicleInputCounters& input = snapshot.vehicle_input;
  const auto refused = [&](const char* reason, uint64_t value) {
    families.count("bevloc_vehicle_refused_total", "Frames and samples of the vehicle not used",
                   value, {{"reason", reason}});
  };
  families.count("bevloc_vehicle_samples_total", "Samples that the vehicle's messages gave",
                 input.odometry_samples, {{"input", "odometry"}});
  families.count("bevloc_vehicle_samples_total", "Samples that the vehicle's messages gave",
                 input.gnss_samples, {{"input", "gnss"}});
  families.count("bevloc_vehicle_slow_odometry_total", "Odometry samples that came too rarely",
                 input.slow_odometry);
  families.count("bevloc_vehicle_frames_lost_total", "Frames that the E2E counter shows missing",
                 input.lost);
  refused("own_ids", input.own_ids);
  refused("foreign", input.foreign);
  refused("wrong_crc", input.wrong_crc);
  refused("wrong_length", input.wrong_length);
  refused("repeated", input.repeated);
  refused("wrong_sequence", input.wrong_sequence);
  refused("not_valid", input.not_valid);
  refused("incomplete", input.incomplete);
  refused("not_available", input.not_available);
  refused("contradicting_wheels", input.contradicting_wheels);
  refused("odometry_jump", input.odometry_jumps);
  refused("sharp_turn", input.sharp_turns);
  if (!snapshot.authentication) return;
  families.count("bevloc_vehicle_authentic_total", "Authentic epochs",
                 snapshot.authentication->authentic);
  refused("wrong_mac", snapshot.authentication->wrong_mac);
  refused("authentication_incomplete", snapshot.authentication->incomplete);
  refused("no_freshness", snapshot.authentication->no_freshness);
  refused("authentication_wrong_length", snapshot.authentication->wrong_length);
  refused("bad_announcement", snapshot.authentication->bad_announcements);
}

void add_gnss(Families& families, const GnssCounters& gnss) {
  using drivers::FixVerdict;
  using drivers::GpsdLine;
  families.gauge("bevloc_gnss_connected", "1 while gpsd is connected", gnss.connected ? 1 : 0);
  families.count("bevloc_gnss_connections_total", "How often gpsd was connected",
                 gnss.gpsd.connected);
  families.count("bevloc_gnss_connections_failed_total", "Attempts to reach gpsd that failed",
                 gnss.gpsd.failed);
  families.count("bevloc_gnss_silences_total",
                 "Connections that were closed because gpsd was silent", gnss.gpsd.silent);
  families.count("bevloc_gnss_samples_total", "Positions of gpsd that were used", gnss.samples);
  families.gauge("bevloc_gnss_age_max_seconds", "Largest age of a position that was used",
                 to_seconds(gnss.max_age));
  const auto refused = [&](const char* reason, uint64_t value) {
    families.count("bevloc_gnss_refused_total", "Reports of gpsd that were not used", value,
                   {{"reason", reason}});
  };
  refused("no_fix", gnss.of(GpsdLine::kNoFix));
  refused("no_accuracy", gnss.of(GpsdLine::kNoAccuracy));
  refused("no_time", gnss.of(GpsdLine::kNoTime));
  refused("not_satellites", gnss.of(GpsdLine::kNotSatellites));
  refused("out_of_range", gnss.of(GpsdLine::kOutOfRange));
  refused("not_readable", gnss.of(GpsdLine::kNotReadable));
  refused("too_long", gnss.gpsd.too_long);
  refused("learning", gnss.of(FixVerdict::kLearning));
  refused("repeated", gnss.of(FixVerdict::kRepeated));
  refused("stale", gnss.of(FixVerdict::kStale));
  refused("future", gnss.of(FixVerdict::kFuture));
  refused("clock_unsynchronized", gnss.of(FixVerdict::kUnsynchronized));
}

void add_bus(Families& families, const Telemetry& telemetry) {
  const Snapshot& snapshot = telemetry.snapshot;
  const can::BusCounters& bus = snapshot.bus;
  const bool running = telemetry.phase == Phase::kRunning;
  for (int i = 0; i <= static_cast<int>(can::BusState::kDown); ++i) {
    const can::BusCondition condition{static_cast<can::BusState>(i), 0};
    families.gauge("bevloc_can_state", "1 for the state of the controller that holds",
                   running && snapshot.bus_condition.state == condition.state ? 1 : 0,
                   {{"state", can::to_string(condition)}});
  }
  const auto dropped = [&](const char* reason, uint64_t value) {
    families.count("bevloc_can_frames_dropped_total", "Frames that were not sent or not read",
                   value, {{"reason", reason}});
  };
  families.count("bevloc_can_frames_sent_total", "Frames given to the controller", bus.sent);
  families.count("bevloc_can_frames_confirmed_total", "Own frames seen on the wire", bus.confirmed);
  families.count("bevloc_can_frames_received_total", "Frames received", bus.received);
  families.count("bevloc_can_error_frames_total", "Error reports of the controller",
                 bus.error_frames);
  families.count("bevloc_can_bus_off_total", "How often the controller went bus-off", bus.bus_off);
  families.count("bevloc_can_reopened_total", "How often a lost interface was found again",
                 bus.reopened);
  families.gauge("bevloc_can_frames_waiting", "Frames that wait for room",
                 static_cast<double>(bus.send_waiting));
  families.count_seconds("bevloc_can_confirmation_seconds_total",
                         "Time from sending to the wire, summed over confirmed frames",
                         to_seconds(bus.confirmation_total));
  dropped("replaced", bus.send_replaced);
  dropped("expired", bus.send_expired);
  dropped("bus_down", bus.send_bus_down);
  dropped("not_read", bus.receive_dropped);
  dropped("overrun", bus.receive_overrun);
  dropped("ignored", bus.receive_ignored);
}

void add_recording(Families& families, const RecordingSnapshot& recording) {
  const auto count = [&](const char* name, const char* help, const char* kind, uint64_t value) {
    families.count(name, help, value, {{"kind", kind}});
  };
  const char* const written = "bevloc_recording_written_total";
  const char* const dropped = "bevloc_recording_dropped_total";
  count(written, "Entries in the recording", "image", recording.images);
  count(written, "Entries in the recording", "event", recording.events);
  count(dropped, "Entries that the recording lacks", "image", recording.images_dropped);
  count(dropped, "Entries that the recording lacks", "event", recording.events_dropped);
  families.count("bevloc_recording_bytes_total", "Bytes that the recording wrote", recording.bytes);
  families.count("bevloc_recording_black_boxes_total", "How often the last minute was kept",
                 recording.black_boxes);
  families.gauge("bevloc_recording_failed",
                 "1 if the recording could not begin, or the disk refused to take more",
                 recording.failed ? 1 : 0);
}

void add_process(Families& families, const Telemetry& telemetry, const ProcessUse& process) {
  const std::string& hung = telemetry.view.hung;
  const auto names = std::count(hung.begin(), hung.end(), ',') + (hung.empty() ? 0 : 1);
  families.gauge("bevloc_threads_hung", "Threads that hang", static_cast<double>(names));
  families.gauge("bevloc_realtime_refusals", "Realtime settings that the kernel refused",
                 telemetry.view.realtime_refusals);
  families.count("bevloc_log_lines_dropped_total", "Lines of the log that were not written",
                 telemetry.snapshot.log_dropped);
  families.gauge("process_resident_memory_bytes", "Resident memory", process.resident_bytes);
  families.count_seconds("process_cpu_seconds_total", "CPU time of all threads", process.cpu_s);
  if (!telemetry.snapshot.trigger) return;
  const TriggerSnapshot& trigger = *telemetry.snapshot.trigger;
  families.count("bevloc_trigger_pulses_total", "Pulses of the trigger line", trigger.pulses);
  families.count("bevloc_trigger_skipped_total", "Pulses that were due and not given",
                 trigger.skipped);
  families.count("bevloc_trigger_failed_total", "Pulses that the line refused", trigger.failed);
}

}  // namespace

std::string metrics_text(const Telemetry& telemetry, const ProcessUse& process, Duration age) {
  Families families;
  families.gauge("bevloc_info", "The version of bevloc", 1, {{"version", std::string(version())}});
  families.gauge("bevloc_healthy", "1 while /healthz answers 200",
                 check_health(telemetry, age).good ? 1 : 0);
  add_state(families, telemetry);
  add_pose(families, telemetry, age);
  for (int camera = 0; camera < kCameraCount; ++camera) add_camera(families, telemetry, camera);
  add_framesets(families, telemetry);
  add_queues(families, telemetry.snapshot.queue_drops);
  add_tracker(families, "odometry", telemetry.snapshot.estimation.odometry);
  add_tracker(families, "gnss", telemetry.snapshot.estimation.gnss);
  add_tracker(families, "correction", telemetry.snapshot.estimation.corrections);
  add_vehicle(families, telemetry.snapshot);
  if (telemetry.snapshot.gnss) add_gnss(families, *telemetry.snapshot.gnss);
  add_bus(families, telemetry);
  if (telemetry.snapshot.recording) add_recording(families, *telemetry.snapshot.recording);
  add_process(families, telemetry, process);
  return families.text();
}

}  // namespace bevloc::firmware
