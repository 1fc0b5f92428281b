#include "training/native/sample_queue.h"

#include <algorithm>
#include <utility>

#include "pipeline/bev_grid.h"

namespace bevloc {

using sim::kSamplesPerWorld;
using sim::Sample;

SampleQueue::SampleQueue(const sim::SampleStream& stream,
                         std::unique_ptr<const sim::PhotoLibrary> photos, uint64_t first_sample,
                         int threads)
    : photos_(std::move(photos)),
      stream_(stream),
      worlds_ahead_(2 * static_cast<uint64_t>(std::max(threads, 1))),
      first_world_(first_sample / kSamplesPerWorld),
      first_in_first_world_(first_sample % kSamplesPerWorld),
      next_world_to_make_(first_world_),
      world_being_read_(first_world_),
      left_in_world_(kSamplesPerWorld - first_in_first_world_) {
  stream_.photos = photos_.get();
  for (int i = 0; i < std::max(threads, 1); ++i) workers_.emplace_back([this] { make_worlds(); });
}

SampleQueue::~SampleQueue() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  room_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

TrainingSample SampleQueue::next() {
  std::unique_lock lock(mutex_);
  std::deque<TrainingSample>& samples = made_[world_being_read_];
  arrived_.wait(lock, [&samples] { return !samples.empty(); });
  TrainingSample sample = std::move(samples.front());
  samples.pop_front();
  if (--left_in_world_ == 0) {
    made_.erase(world_being_read_++);
    left_in_world_ = kSamplesPerWorld;
    room_.notify_all();
  }
  return sample;
}

void SampleQueue::make_worlds() {
  while (true) {
    uint64_t world = 0;
    {
      std::unique_lock lock(mutex_);
      room_.wait(lock, [this] {
        return stopping_ || next_world_to_make_ < world_being_read_ + worlds_ahead_;
      });
      if (stopping_) return;
      world = next_world_to_make_++;
    }
    const uint64_t first = world == first_world_ ? first_in_first_world_ : 0;
    sim::make_samples_of_world(stream_, world, first, [this, world](Sample&& sample) {
      ViewTable table =
          make_view_table(sample.rig, sample.cameras, kFeatureGrid, sample.reference_from_exposure);
      const std::lock_guard lock(mutex_);
      made_[world].push_back({std::move(sample), std::move(table)});
      if (world == world_being_read_) arrived_.notify_one();
      return !stopping_;
    });
  }
}

}  // namespace bevloc
