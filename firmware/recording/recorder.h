// Records what the appliance sees, decides and sends.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <vector>

#include "common/bounded_queue.h"
#include "common/health_state.h"
#include "common/jpeg.h"
#include "firmware/config/record_config.h"
#include "firmware/recording/image_memory.h"
#include "firmware/recording/recorded_events.h"
#include "firmware/recording/recording_ring.h"
#include "firmware/stages/vision_stage.h"
#include "firmware/telemetry/cause_log.h"

namespace bevloc::firmware {

struct RecordingSnapshot;
struct Snapshot;

/// Totals since start; readable from any thread. Each image and each event counts once.
struct RecorderCounters {
  std::atomic<uint64_t> images{0};  ///< images that are on the disk
  /// Events on the disk: bus frames, fixes, solutions and matches.
  std::atomic<uint64_t> events{0};
  std::atomic<uint64_t> images_dropped{0};      ///< no memory was free
  std::atomic<uint64_t> images_too_large{0};    ///< do not fit into the memory of their camera
  std::atomic<uint64_t> images_not_encoded{0};  ///< cannot be encoded
  std::atomic<uint64_t> images_lost{0};         ///< lost because writing failed
  std::atomic<uint64_t> events_lost{0};         ///< lost because writing failed
  std::atomic<uint64_t> bytes{0};
  std::atomic<uint64_t> black_boxes{0};
  std::atomic<bool> failed{false};  ///< writing has failed, and nothing is recorded since then
};

/// The stages copy what is to be recorded into memory that was allocated at the start, and never
/// wait. write_queued() writes it. When the disk is too slow, the oldest entries are dropped and
/// counted. When the disk fails, recording ends and the appliance goes on.
///
/// Thread-bound: note_image() is called from the camera's own thread, note_match() from the vision
/// thread, write_queued() and finish() from the recorder's thread. The other note functions are
/// thread-safe. counters() and totals() are readable from any thread.
class Recorder {
 public:
  /// `log_time_minus_clock` plus the time of the appliance's clock is the time since 1970. Fails if
  /// the folder or its first file cannot be created.
  static Result<std::unique_ptr<Recorder>> open(const RecordConfig& config, RecordingHead head,
                                                Duration log_time_minus_clock, Time now);

  /// Allocates the memory for the images of one camera. Call it before the first note_image().
  void expect_images(int camera, int width_px, int height_px);

  void note_image(const drivers::Frame& frame, Time now);
  void note_bus_frame(const RecordedBusFrame& frame) { events_.push(frame); }
  void note_fix(const RecordedFix& fix) { events_.push(fix); }
  void note_solution(const can::PoseReport& report) { events_.push(RecordedSolution{report}); }
  void note_truth(const RecordedTruth& truth) { events_.push(truth); }
  void note_match(const VisionSnapshot& snapshot, Time now);

  /// Sets the source of the counters that write_queued() records twice a second. It is called in
  /// the thread of write_queued().
  void count_with(std::function<Snapshot()> snapshot) { snapshot_ = std::move(snapshot); }

  /// Writes all queued events and a few images, and does what is due at `now`: chunks to the disk,
  /// the next file, the black box. Logs the first failure, and once each reason for a drop.
  void write_queued(Time now);
  /// Writes the rest and ends the file. Logs the totals.
  void finish(Time now);

  const RecorderCounters& counters() const { return counters_; }
  /// Returns the totals, which include what the queues dropped.
  RecordingSnapshot totals() const;
  uint64_t images_dropped() const {
    return slow_images() + counters_.images_too_large + counters_.images_not_encoded +
           counters_.images_lost;
  }
  uint64_t events_dropped() const { return slow_events() + counters_.events_lost; }

 private:
  Recorder(const RecordConfig& config, RecordingRing ring, Duration log_time_minus_clock)
      : config_(config), offset_(log_time_minus_clock), ring_(std::move(ring)) {}

  /// What was dropped because this thread or the disk was too slow.
  uint64_t slow_images() const { return counters_.images_dropped + images_.dropped(); }
  uint64_t slow_events() const { return events_.dropped() + matches_.dropped(); }
  uint64_t log_time(Time time) const;
  void put(std::string_view topic, const google::protobuf::Message& message, Time time,
           Time made_at);
  void write_events();
  void write_image(const RecordedImage& image);
  Status put_image(const RecordedImage& image);
  void write_event(const RecordedBusFrame& frame);
  void write_event(const RecordedFix& fix);
  void write_event(const RecordedSolution& solution);
  void write_event(const RecordedTruth& truth);
  void write_match(const RecordedMatch& match);
  void count_event();
  /// Counts what was written since the latest call as written to the disk, or as lost if writing
  /// failed.
  void settle();
  void write_counters(Time now);
  void watch_state(HealthState state, Time now);
  void note_failure(const Status& status);
  void log_drops();

  const RecordConfig config_;
  const Duration offset_;
  RecordingRing ring_;
  std::array<std::unique_ptr<ImageMemory>, kCameraCount> memory_;
  BoundedQueue<RecordedImage> images_{ImageMemory::kMostImages * kCameraCount};
  /// The events of two seconds of a busy bus.
  BoundedQueue<RecordedEvent> events_{8192};
  BoundedQueue<RecordedMatch> matches_{64};
  std::function<Snapshot()> snapshot_;
  JpegEncoder jpeg_;
  uint64_t images_written_ = 0;  ///< since the latest settle()
  uint64_t events_written_ = 0;
  Time next_step_ = Time::min();
  HealthState state_ = HealthState::kInit;
  bool drops_logged_ = false;
  bool too_large_logged_ = false;
  CauseLog causes_;  ///< why images could not be encoded
  RecorderCounters counters_;
};

}  // namespace bevloc::firmware
