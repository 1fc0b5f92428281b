#include "training/native/sampler.h"

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "pipeline/network/view/view_table.h"
#include "sim/render/photo_library.h"
#include "sim/samples/sample_maker.h"

using bevloc::Se2;
using bevloc::sim::kSamplesPerWorld;
using bevloc::sim::PhotoLibrary;
using bevloc::sim::Sample;
using bevloc::sim::SampleStream;

namespace {

/// Both functions return the position after the motion.
float* write_motion(const Se2& motion, float* out) {
  *out++ = static_cast<float>(motion.x_m);
  *out++ = static_cast<float>(motion.y_m);
  *out++ = static_cast<float>(motion.yaw_rad);
  return out;
}

const float* read_motion(const float* in, Se2& motion) {
  motion = {in[0], in[1], in[2]};
  return in + 3;
}

constexpr int kRigFloats = 15;

/// Returns the position after the camera.
float* write_camera(const bevloc::CameraModel& camera, float* out) {
  const bevloc::Intrinsics& intrinsics = camera.intrinsics;
  const bevloc::Se3& pose = camera.vehicle_from_camera;
  for (const double value : {intrinsics.fx_px, intrinsics.cx_px, intrinsics.cy_px}) {
    *out++ = static_cast<float>(value);
  }
  for (const double value : pose.rotation.reshaped<Eigen::RowMajor>()) {
    *out++ = static_cast<float>(value);
  }
  for (const double value : pose.translation_m) *out++ = static_cast<float>(value);
  return out;
}

bevloc::Rig read_rig(const float* in) {
  bevloc::Rig rig = bevloc::sim::nominal_network_rig();
  for (bevloc::CameraModel& camera : rig.cameras) {
    camera.intrinsics.fx_px = camera.intrinsics.fy_px = in[0];
    camera.intrinsics.cx_px = in[1];
    camera.intrinsics.cy_px = in[2];
    using Rows = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
    camera.vehicle_from_camera.rotation = Eigen::Map<const Rows>(in + 3).cast<double>();
    camera.vehicle_from_camera.translation_m =
        Eigen::Map<const Eigen::Vector3f>(in + 12).cast<double>();
    in += kRigFloats;
  }
  return rig;
}

}  // namespace

/// Workers that make samples ahead of their use. Each worker makes whole worlds; samples are
/// returned in order, world by world. To limit the memory, a worker waits before it starts a world
/// that is too far ahead of the one being read.
struct bevloc_sampler {
 public:
  /// `photos` may be null.
  bevloc_sampler(const SampleStream& stream, std::unique_ptr<const PhotoLibrary> photos,
                 uint64_t first_sample, int threads)
      : photos_(std::move(photos)),
        stream_(stream),
        worlds_ahead_(2 * static_cast<uint64_t>(threads)),
        first_world_(first_sample / kSamplesPerWorld),
        first_in_first_world_(first_sample % kSamplesPerWorld),
        next_world_to_make_(first_world_),
        world_being_read_(first_world_),
        left_in_world_(kSamplesPerWorld - first_in_first_world_) {
    stream_.photos = photos_.get();
    for (int i = 0; i < threads; ++i) workers_.emplace_back([this] { make_worlds(); });
  }

  ~bevloc_sampler() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    room_.notify_all();
    for (std::thread& worker : workers_) worker.join();
  }

  bevloc_sampler(const bevloc_sampler&) = delete;
  bevloc_sampler& operator=(const bevloc_sampler&) = delete;

  /// The next sample in order. Blocks until it is made.
  Sample next() {
    std::unique_lock lock(mutex_);
    std::deque<Sample>& samples = made_[world_being_read_];
    arrived_.wait(lock, [&samples] { return !samples.empty(); });
    Sample sample = std::move(samples.front());
    samples.pop_front();
    if (--left_in_world_ == 0) {
      made_.erase(world_being_read_++);
      left_in_world_ = kSamplesPerWorld;
      room_.notify_all();
    }
    return sample;
  }

 private:
  void make_worlds() {
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
      bevloc::sim::make_samples_of_world(stream_, world, first, [this, world](Sample&& sample) {
        const std::lock_guard lock(mutex_);
        made_[world].push_back(std::move(sample));
        if (world == world_being_read_) arrived_.notify_one();
        return !stopping_;
      });
    }
  }

  const std::unique_ptr<const PhotoLibrary> photos_;
  SampleStream stream_;  ///< constant once the workers run
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
  std::map<uint64_t, std::deque<Sample>> made_;

  std::vector<std::thread> workers_;
};

namespace {

constexpr int kStrong = 1;
constexpr int kStreet = 2;

}  // namespace

bevloc_sampler* bevloc_sampler_create(uint64_t first_seed, uint64_t first_sample, int threads,
                                      double drop_camera_probability, int nuisances,
                                      const char* photos) {
  std::unique_ptr<PhotoLibrary> library;
  if (photos != nullptr) {
    auto loaded = PhotoLibrary::load(photos);
    if (!loaded) {
      std::fprintf(stderr, "%s\n", loaded.error().message.c_str());
      return nullptr;
    }
    library = std::make_unique<PhotoLibrary>(std::move(*loaded));
  }
  SampleStream stream;
  stream.first_seed = first_seed;
  stream.nuisances.missing_cameras.probability = drop_camera_probability;
  if (nuisances == kStrong) stream.training = bevloc::sim::strong_nuisances();
  if (nuisances == kStreet) stream.training = bevloc::sim::street_nuisances();
  return new bevloc_sampler(stream, std::move(library), first_sample, std::max(threads, 1));
}

void bevloc_sampler_destroy(bevloc_sampler* sampler) {
  delete sampler;
}

void bevloc_sampler_next(bevloc_sampler* sampler, int count, uint8_t* images, uint8_t* camera_mask,
                         uint8_t* raster_prior, uint8_t* raster_truth, float* correction,
                         float* motions, float* rig) {
  for (int i = 0; i < count; ++i) {
    const Sample sample = sampler->next();
    images = std::copy(sample.images.begin(), sample.images.end(), images);
    raster_prior = std::copy(sample.raster_prior.begin(), sample.raster_prior.end(), raster_prior);
    raster_truth = std::copy(sample.raster_truth.begin(), sample.raster_truth.end(), raster_truth);
    *camera_mask++ = static_cast<uint8_t>(sample.cameras.to_ulong());
    correction = write_motion(sample.correction, correction);
    for (const Se2& motion : sample.reference_from_exposure)
      motions = write_motion(motion, motions);
    for (const bevloc::CameraModel& camera : sample.rig.cameras) rig = write_camera(camera, rig);
  }
}

void bevloc_view_table(uint8_t camera_mask, int32_t* index, float* weight, const float* motions,
                       const float* rig) {
  bevloc::CameraMotions reference_from_exposure{};
  if (motions != nullptr) {
    for (Se2& motion : reference_from_exposure) motions = read_motion(motions, motion);
  }
  const bevloc::ViewTable table = bevloc::make_view_table(
      rig != nullptr ? read_rig(rig) : bevloc::sim::nominal_network_rig(),
      bevloc::CameraMask(camera_mask), bevloc::kFeatureGrid, reference_from_exposure);
  std::copy(table.index.begin(), table.index.end(), index);
  std::copy(table.weight.begin(), table.weight.end(), weight);
}
