// Tests that /metrics shows each counter.
#include "firmware/status/metrics.h"

#include <array>
#include <bit>
#include <set>
#include <type_traits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "firmware/status/status_json.h"

namespace bevloc::firmware {
namespace {

/// Gives each counter a value of its own.
class DistinctCounters {
 public:
  /// Fills one counter, or a struct or an array that has nothing but counters.
  template <typename T>
  void fill(T& counters) {
    static_assert(std::has_unique_object_representations_v<T>, "it has only 64-bit members");
    std::array<uint64_t, sizeof(T) / sizeof(uint64_t)> values{};
    for (uint64_t& value : values) shown_.insert(value = next_++);
    counters = std::bit_cast<T>(values);
  }
  /// Takes note that a counter is not shown.
  void leave_out(uint64_t counter) { EXPECT_EQ(shown_.erase(counter), 1U); }

  const std::set<uint64_t>& shown() const { return shown_; }

 private:
  uint64_t next_ = 10'001;
  std::set<uint64_t> shown_;
};

void fill_cameras(DistinctCounters& counters, Snapshot& snapshot) {
  for (CameraSnapshot& camera : snapshot.cameras) {
    for (uint64_t* count : {&camera.captured, &camera.failures, &camera.unreadable}) {
      counters.fill(*count);
    }
    counters.fill(camera.driver);
    counters.fill(camera.synchronizer);
    // `captured` counts the same frames.
    counters.leave_out(camera.driver.delivered);
    counters.leave_out(camera.synchronizer.added);
    counters.leave_out(camera.synchronizer.emitted);
  }
  for (uint64_t* count : {&snapshot.frames.used, &snapshot.frames.displaced}) counters.fill(*count);
}

void fill_estimation(DistinctCounters& counters, Snapshot& snapshot) {
  FramesetsSnapshot& framesets = snapshot.framesets;
  for (uint64_t* count : {&framesets.taken, &framesets.skipped, &framesets.no_prior,
                          &framesets.refused, &framesets.off_pulse, &framesets.network_checks}) {
    counters.fill(*count);
  }
  EstimationSnapshot& estimation = snapshot.estimation;
  for (uint64_t* count : {&estimation.lost, &estimation.ticks, &estimation.clock_gaps}) {
    counters.fill(*count);
  }
  counters.fill(estimation.odometry);
  counters.fill(estimation.gnss);
  counters.fill(estimation.corrections);
}

void fill_gnss(DistinctCounters& counters, GnssCounters& gnss) {
  using drivers::FixVerdict;
  using drivers::GpsdLine;
  counters.fill(gnss.samples);
  counters.fill(gnss.fixes);
  counters.fill(gnss.gpsd.lines);
  for (uint64_t* count :
       {&gnss.gpsd.too_long, &gnss.gpsd.connected, &gnss.gpsd.failed, &gnss.gpsd.silent}) {
    counters.fill(*count);
  }
  // Nothing is wrong with these.
  counters.leave_out(gnss.of(FixVerdict::kUsable));
  counters.leave_out(gnss.of(GpsdLine::kFix));
  counters.leave_out(gnss.of(GpsdLine::kAccuracy));
  counters.leave_out(gnss.of(GpsdLine::kOther));
}

void fill_bus(DistinctCounters& counters, can::BusCounters& bus) {
  counters.fill(bus);
  // The totals at the end have these.
  counters.leave_out(bus.hardware_stamped);
  counters.leave_out(bus.software_stamped);
  // These are no counters.
  counters.leave_out(static_cast<uint64_t>(bus.confirmation_total.count()));
  counters.leave_out(static_cast<uint64_t>(bus.confirmation_max.count()));
}

void fill_others(DistinctCounters& counters, Snapshot& snapshot) {
  counters.fill(snapshot.queue_drops);
  counters.fill(snapshot.vehicle_input);
  counters.fill(snapshot.authentication.emplace());
  counters.fill(snapshot.log_dropped);
  TriggerSnapshot& trigger = snapshot.trigger.emplace();
  for (uint64_t* count : {&trigger.pulses, &trigger.skipped, &trigger.failed}) {
    counters.fill(*count);
  }
  RecordingSnapshot& recording = snapshot.recording.emplace();
  for (uint64_t* count : {&recording.images, &recording.events, &recording.images_dropped,
                          &recording.events_dropped, &recording.bytes, &recording.black_boxes}) {
    counters.fill(*count);
  }
}

TEST(MetricsTest, ShowEachCounter) {
  Telemetry telemetry;
  telemetry.phase = Phase::kRunning;
  Snapshot& snapshot = telemetry.snapshot;
  DistinctCounters counters;
  fill_cameras(counters, snapshot);
  fill_estimation(counters, snapshot);
  fill_gnss(counters, snapshot.gnss.emplace());
  fill_bus(counters, snapshot.bus);
  fill_others(counters, snapshot);
  const std::string text = metrics_text(telemetry, {}, Duration{});
  for (const uint64_t value : counters.shown()) {
    EXPECT_NE(text.find(" " + std::to_string(value) + "\n"), std::string::npos)
        << value << " is the value of a counter that no metric shows";
  }
  const nlohmann::json status = status_json(telemetry, {}, Duration{});
  EXPECT_EQ(status["cycles"], snapshot.estimation.ticks);
  EXPECT_EQ(status["cameras"][2]["waited_framesets"], snapshot.cameras[2].synchronizer.waited_for);
  EXPECT_EQ(status["gnss"]["connections_failed"], snapshot.gnss->gpsd.failed);
  EXPECT_EQ(status["gnss"]["silences"], snapshot.gnss->gpsd.silent);
}

}  // namespace
}  // namespace bevloc::firmware
