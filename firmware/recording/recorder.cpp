#include "firmware/recording/recorder.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "firmware/recording/messages.h"
#include "firmware/recording/topics.h"
#include "firmware/status/snapshot.h"

namespace bevloc::firmware {
namespace {

/// The period in which chunks go to the disk and counters are recorded.
constexpr Duration kStep = std::chrono::milliseconds(500);

void copy_distribution(const std::vector<float>& from, RecordedDistribution& to) {
  to.count = from.size() <= to.probability.size() ? from.size() : 0;
  std::copy_n(from.begin(), to.count, to.probability.begin());
}

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::open(const RecordConfig& config, RecordingHead head,
                                                 Duration log_time_minus_clock, Time now) {
  const Duration begin = now.time_since_epoch() + log_time_minus_clock;
  auto ring = RecordingRing::open(config, std::move(head), static_cast<uint64_t>(begin.count()));
  if (!ring) return tl::unexpected(ring.error());
  spdlog::info("recording: writes {}", ring->file().string());
  return std::unique_ptr<Recorder>(new Recorder(config, std::move(*ring), log_time_minus_clock));
}

void Recorder::expect_images(int camera, int width_px, int height_px) {
  memory_[camera] = std::make_unique<ImageMemory>(width_px, height_px);
}

void Recorder::note_image(const drivers::Frame& frame, Time now) {
  ImageMemory& memory = *memory_[frame.camera];
  if (!memory.fits(frame.image())) {
    ++counters_.images_too_large;
  } else if (auto copy = memory.copy(frame, now)) {
    images_.push(std::move(*copy));
  } else {
    ++counters_.images_dropped;
  }
}

void Recorder::note_match(const VisionSnapshot& snapshot, Time now) {
  RecordedMatch match;
  match.time = now;
  match.frame_time = snapshot.frameset.time;
  match.cameras = static_cast<unsigned>(snapshot.report.present.to_ulong());
  match.acquiring = snapshot.range == SearchRange::kAcquiring;
  match.prior = snapshot.report.prior;
  match.match = snapshot.report.match;
  match.ranges = {snapshot.hypotheses.x_m.range, snapshot.hypotheses.y_m.range,
                  snapshot.hypotheses.yaw_rad.range};
  copy_distribution(snapshot.solution.x_probability, match.distributions[0]);
  copy_distribution(snapshot.solution.y_probability, match.distributions[1]);
  copy_distribution(snapshot.solution.yaw_probability, match.distributions[2]);
  matches_.push(match);
}

uint64_t Recorder::log_time(Time time) const {
  return static_cast<uint64_t>((time.time_since_epoch() + offset_).count());
}

void Recorder::put(std::string_view topic, const google::protobuf::Message& message, Time time,
                   Time made_at) {
  note_failure(ring_.write(topic, message, log_time(time), log_time(made_at)));
}

void Recorder::note_failure(const Status& status) {
  if (status || counters_.failed.exchange(true)) return;
  settle();
  spdlog::error("recording ends: {}", status.error().message);
}

void Recorder::write_events() {
  while (const auto event = events_.pop(Duration::zero())) {
    if (!counters_.failed) {
      std::visit([this](const auto& recorded) { write_event(recorded); }, *event);
    }
    count_event();
  }
  while (const auto match = matches_.pop(Duration::zero())) {
    if (!counters_.failed) write_match(*match);
    count_event();
  }
}

void Recorder::count_event() {
  if (counters_.failed) {
    ++counters_.events_lost;
  } else {
    ++events_written_;
  }
}

void Recorder::settle() {
  (counters_.failed ? counters_.images_lost : counters_.images) +=
      std::exchange(images_written_, 0);
  (counters_.failed ? counters_.events_lost : counters_.events) +=
      std::exchange(events_written_, 0);
}

void Recorder::write_queued(Time now) {
  // Events come first, because they are small, and on a busy machine the images take long.
  write_events();
  for (int i = 0; i < kCameraCount; ++i) {
    const auto image = images_.pop(Duration::zero());
    if (!image) break;
    write_image(*image);
  }
  if (counters_.failed || now < next_step_) return;
  next_step_ = now + kStep;
  write_counters(now);
  note_failure(ring_.step(log_time(now)));
  settle();
  counters_.bytes = ring_.bytes_written();
  log_drops();
}

void Recorder::write_image(const RecordedImage& image) {
  const Status made = counters_.failed ? Status() : put_image(image);
  if (!made && causes_.is_new(made.error().message, image.time)) {
    spdlog::warn("recording: an image of camera {} is left out: {}", kCameraNames[image.camera],
                 made.error().message);
  }
  if (!made) {
    ++counters_.images_not_encoded;
  } else if (counters_.failed) {
    ++counters_.images_lost;
  } else {
    ++images_written_;
  }
}

Status Recorder::put_image(const RecordedImage& image) {
  const std::string topic = image_topic(image.camera);
  const uint64_t start_ns = log_time(image.exposure_start);
  if (image.image.format == PixelFormat::kMjpeg) {
    const std::string_view file(reinterpret_cast<const char*>(image.image.planes[0].data),
                                image.image.bytes_used);
    put(topic, compressed_image(image, file, start_ns), image.time, image.exposure_start);
    return {};
  }
  if (config_.images == RecordedImages::kJpeg && can_encode_jpeg(image.image.format)) {
    const auto jpeg = jpeg_.encode(image.image, config_.jpeg_quality);
    if (!jpeg) return tl::unexpected(jpeg.error());
    put(topic, compressed_image(image, *jpeg, start_ns), image.time, image.exposure_start);
    return {};
  }
  put(topic, raw_image(image, start_ns), image.time, image.exposure_start);
  return {};
}

void Recorder::write_event(const RecordedBusFrame& frame) {
  put(frame.sent ? kBusOutTopic : kBusInTopic, bus_message(frame), frame.time, frame.stamp);
}

void Recorder::write_event(const RecordedFix& fix) {
  put(kGnssTopic, fix_message(fix, log_time(fix.held.time)), fix.time, fix.held.time);
}

void Recorder::write_event(const RecordedSolution& solution) {
  const can::PoseReport& report = solution.report;
  const Time time = report.pose_time;
  put(kSolutionTopic, solution_message(report), time, time);
  if (report.map_from_vehicle.is_finite()) {
    put(kPoseTopic, pose_message(report.map_from_vehicle, log_time(time)), time, time);
  }
  watch_state(report.status.state, time);
}

void Recorder::write_event(const RecordedTruth& truth) {
  put(kTruthTopic, pose_message(truth.map_from_vehicle, log_time(truth.time)), truth.time,
      truth.time);
}

void Recorder::write_match(const RecordedMatch& match) {
  put(kMatchTopic, match_message(match), match.time, match.frame_time);
}

void Recorder::write_counters(Time now) {
  if (!snapshot_) return;
  const Snapshot snapshot = snapshot_();
  recording::Counters message;
  message.set_frames_captured(snapshot.frames.captured);
  message.set_frames_used(snapshot.frames.used);
  message.set_frames_missed(snapshot.frames.missed);
  message.set_frames_displaced(snapshot.frames.displaced);
  message.set_frames_mismatched(snapshot.frames.mismatched);
  message.set_frames_skipped(snapshot.frames.skipped);
  message.set_framesets(snapshot.framesets.taken);
  message.set_bus_sent(snapshot.bus.sent);
  message.set_bus_received(snapshot.bus.received);
  message.set_bus_lost(snapshot.bus.send_dropped() + snapshot.bus.receive_dropped);
  message.set_images_not_recorded(images_dropped());
  message.set_events_not_recorded(events_dropped());
  put(kCountersTopic, message, now, now);
}

RecordingSnapshot Recorder::totals() const {
  return {.images = counters_.images,
          .events = counters_.events,
          .images_dropped = images_dropped(),
          .events_dropped = events_dropped(),
          .bytes = counters_.bytes,
          .black_boxes = counters_.black_boxes,
          .failed = counters_.failed};
}

void Recorder::watch_state(HealthState state, Time now) {
  const bool bad = state == HealthState::kLost || state == HealthState::kFault;
  const bool became_bad = bad && state != state_;
  state_ = state;
  if (!became_bad) return;
  const auto kept = ring_.keep(log_time(now));
  if (!kept) return spdlog::warn("recording: {}", kept.error().message);
  ++counters_.black_boxes;
  spdlog::warn("recording: {}, so the last minute is kept in {}", to_string(state), kept->string());
}

void Recorder::log_drops() {
  if (!drops_logged_ && slow_images() + slow_events() > 0) {
    drops_logged_ = true;
    spdlog::warn(
        "recording: {} images and {} events were dropped because encoder or disk is too slow; "
        "record JPEG, or use a faster disk",
        slow_images(), slow_events());
  }
  if (!too_large_logged_ && counters_.images_too_large > 0) {
    too_large_logged_ = true;
    spdlog::warn(
        "recording: {} images are left out because they are larger than three bytes for each pixel "
        "of the rig; check the cameras' format and size",
        counters_.images_too_large.load());
  }
}

void Recorder::finish(Time now) {
  while (const auto image = images_.pop(Duration::zero())) write_image(*image);
  write_queued(now);
  if (!counters_.failed) note_failure(ring_.finish());
  settle();
  counters_.bytes = ring_.bytes_written();
  spdlog::info("recording: {} images and {} events in {:.1f} MB, {} images and {} events dropped",
               counters_.images.load(), counters_.events.load(),
               static_cast<double>(counters_.bytes) / 1e6, images_dropped(), events_dropped());
}

}  // namespace bevloc::firmware
