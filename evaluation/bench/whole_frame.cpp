#include "evaluation/bench/whole_frame.h"

#include "evaluation/bench/allocation_count.h"
#include "firmware/config/localizer_options.h"
#include "firmware/runtime/appliance.h"
#include "firmware/runtime/identity.h"

namespace bevloc::bench {
namespace {

/// Does nothing when a buffer is returned, because the bench owns the images.
class ImageLender final : public drivers::FrameLender {
 private:
  void give_back(int /*slot*/) noexcept override {}
};

template <typename Item>
void clear(BoundedQueue<Item>& queue) {
  while (queue.pop(Duration::zero())) {
  }
}

}  // namespace

Result<std::unique_ptr<WholeFrame>> WholeFrame::create(const firmware::Config& config,
                                                       const Rig& rig, const HdMap& map,
                                                       const MapIndex& index, int threads) {
  LocalizerOptions options = firmware::localizer_options_of(config);
  options.network.threads = threads;
  auto localizer = Localizer::create(rig, index, config.model_file.string(), options);
  if (!localizer) return tl::unexpected(localizer.error());
  return std::unique_ptr<WholeFrame>(new WholeFrame(config, map, std::move(*localizer)));
}

WholeFrame::WholeFrame(const firmware::Config& config, const HdMap& map,
                       std::unique_ptr<Localizer> localizer)
    : config_(config),
      map_(map),
      localizer_(std::move(localizer)),
      bus_(wire_.connect()),
      listener_(wire_.connect()),
      lender_(std::make_shared<ImageLender>()) {}

bool WholeFrame::settle(const Place& place) {
  vehicle_.map_from_vehicle = place.map_from_vehicle;
  // Remove the measurements of the previous place.
  clear(queues_.samples);
  clear(queues_.reports);
  clear(queues_.predictions);
  publisher_.emplace(*bus_, firmware::publisher_config(config_, map_));
  estimation_.emplace(config_.tracker, config_.health, firmware::map_id_of(map_), *publisher_,
                      queues_.samples, queues_.reports, queues_.predictions);
  firmware::VisionConfig vision;
  vision.synchronizer = config_.cameras.synchronizer;
  vision.compensate_motion = config_.cameras.compensate_motion;
  vision_.emplace(*localizer_, vision, queues_.frames, queues_.predictions, queues_.reports);
  const size_t framesets = place.framesets.size();
  size_t in_a_row = 0;
  for (size_t i = 0; i < kMostFrames; ++i) {
    const bool tracked = run(place.framesets[i % framesets]).tracked;
    in_a_row = tracked ? in_a_row + 1 : 0;
    if (in_a_row > framesets) return true;
  }
  return false;
}

FrameRun WholeFrame::run(const FramesetImages& images) {
  exposure_ = clock_.now();
  estimation_->tick(clock_);
  drive_until(exposure_ + kImageDelay);
  take_sent();
  ++sequence_;
  FrameRun done;
  const uint64_t allocated_before = allocation_count();
  const Time start = machine_clock_.now();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    drivers::Frame frame;
    frame.camera = camera;
    frame.time = exposure_;
    frame.sequence = sequence_;
    frame.buffer = drivers::FrameBuffer(lender_, camera, ImageView(images[camera].view()));
    queues_.frames.push(std::move(frame));
  }
  vision_->step(clock_, Duration::zero());
  estimation_->tick(clock_);
  done.time = machine_clock_.now() - start;
  done.allocations = allocation_count() - allocated_before;
  done.can_frames = take_sent();
  done.tracked = estimation_->counters().state == HealthState::kTracking;
  drive_until(exposure_ + kFramePeriod);
  return done;
}

/// Runs the bus cycles up to `time`. The samples of `time` itself are queued but not yet processed.
void WholeFrame::drive_until(Time time) {
  while (clock_.now() < time) {
    clock_.advance(kBusCycle);
    const Time now = clock_.now();
    queues_.samples.push(vehicle_.odometry(now));
    if ((now - Time{}) % kFramePeriod == Duration::zero()) queues_.samples.push(vehicle_.gnss(now));
    if (now < time) estimation_->tick(clock_);
  }
}

int WholeFrame::take_sent() {
  int sent = 0;
  while (listener_->receive()) ++sent;
  return sent;
}

}  // namespace bevloc::bench
