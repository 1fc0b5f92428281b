// Samples of the simulator for training, rendered ahead by worker threads.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "pipeline/network/view/view_table.h"
#include "sim/render/photo_library.h"
#include "sim/samples/sample_maker.h"
#include "training/native/sample_record.h"

namespace bevloc {

/// A sample and the view table of its rig, of the cameras that it has and of their motions.
struct TrainingSample {
  sim::Sample sample;
  ViewTable table;

  SampleContent content() const {
    return {sample.images, sample.raster_prior, sample.raster_truth,
            table,         sample.correction,   sample.cameras};
  }
};

/// Workers that make samples ahead of their use. Each worker makes whole worlds; samples are
/// returned in order, world by world. To limit the memory, a worker waits before it starts a world
/// that is too far ahead of the one being read.
class SampleQueue {
 public:
  /// Starts `threads` workers (at least one). `stream`: its `photos` are replaced by `photos`,
  /// which may be null. `first_sample` starts a stream in its middle. Sample i depends on the
  /// stream and i alone, not on the number of workers.
  SampleQueue(const sim::SampleStream& stream, std::unique_ptr<const sim::PhotoLibrary> photos,
              uint64_t first_sample, int threads);
  /// Stops the workers; each finishes the sample that it is making.
  ~SampleQueue();
  SampleQueue(const SampleQueue&) = delete;
  SampleQueue& operator=(const SampleQueue&) = delete;

  /// The next sample in order. Blocks until it is made. Only one thread may call it.
  TrainingSample next();

 private:
  void make_worlds();

  const std::unique_ptr<const sim::PhotoLibrary> photos_;
  sim::SampleStream stream_;  ///< constant once the workers run
  const uint64_t worlds_ahead_;
  const uint64_t first_world_;
  const uint64_t first_in_first_world_;

  std::mutex mutex_;  ///< guards all members up to made_
  std::condition_variable room_;
  std::condition_variable arrived_;
  bool stopping_ = false;
  uint64_t next_world_to_make_;
  uint64_t world_being_read_;
  uint64_t left_in_world_;
  std::map<uint64_t, std::deque<TrainingSample>> made_;

  std::vector<std::thread> workers_;
};

}  // namespace bevloc
