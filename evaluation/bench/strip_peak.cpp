#include "evaluation/bench/strip_peak.h"

#include <array>
#include <cstdint>
#include <deque>

#include <omp.h>

#include "common/cache_line_allocator.h"
#include "pipeline/network/engine/parallel_for.h"
#include "pipeline/network/kernels/strip_kernels.h"

namespace bevloc::bench {
namespace {

constexpr int kRows = 3;
constexpr int kCols = 3;
constexpr int kChannels = 64;
constexpr int kPixels = 56;
constexpr int kWordBytes = 4;
constexpr int kStripsPerThread = 128;

struct WidestKernel {
  nn::StripKernel run = nullptr;
  int lanes = 0;
};

WidestKernel widest_kernel(const nn::KernelSet& set) {
  WidestKernel widest;
  for (int vectors = 1; vectors <= nn::KernelSet::kMostVectors; ++vectors) {
    if (set.kernels[vectors][0] != nullptr) widest = {set.kernels[vectors][0], vectors * set.lanes};
  }
  return widest;
}

/// The data of one thread.
class Strip {
 public:
  Strip(const WidestKernel& kernel, int step_words)
      : line_((kPixels + kCols - 1) * kChannels, 1),
        weights_(weight_bytes(kernel.lanes, step_words), 1),
        starts_(static_cast<size_t>(kernel.lanes)),
        sums_(static_cast<size_t>(kPixels * kernel.lanes)) {
    lines_.fill(line_.data());
    strip_ = {.lines = lines_.data(),
              .rows = kRows,
              .words = kCols * kChannels / kWordBytes,
              .pixel_step = kChannels,
              .weights = weights_.data(),
              .start = starts_.data(),
              .pixels = kPixels,
              .sums = sums_.data(),
              .sums_step = kernel.lanes};
  }
  // strip_ points into this object.
  Strip(const Strip&) = delete;
  Strip& operator=(const Strip&) = delete;

  void run(nn::StripKernel kernel) const {
    for (int i = 0; i < kStripsPerThread; ++i) kernel(strip_);
  }

 private:
  static size_t weight_bytes(int lanes, int step_words) {
    constexpr int kWords = kCols * kChannels / kWordBytes;
    const int steps = (kWords + step_words - 1) / step_words;
    return static_cast<size_t>(kRows * steps * step_words * kWordBytes * lanes);
  }

  CacheLineVector<uint8_t> line_;
  CacheLineVector<int8_t> weights_;
  CacheLineVector<int32_t> starts_;
  CacheLineVector<int32_t> sums_;
  std::array<const uint8_t*, kRows> lines_{};
  nn::KernelStrip strip_;
};

}  // namespace

double strip_macs_per_s(int threads, const TimeOfRun& time_s) {
  const nn::KernelSet& set = *nn::kernel_sets().front();
  const WidestKernel kernel = widest_kernel(set);
  std::deque<Strip> strips;
  for (int i = 0; i < threads; ++i) strips.emplace_back(kernel, set.step_words);
  omp_set_num_threads(threads);
  const double seconds = time_s([&] {
    nn::onednn::parallel_for(threads,
                             [&](int i) { strips[static_cast<size_t>(i)].run(kernel.run); });
  });
  constexpr double kMacsPerLane = double{kStripsPerThread} * kPixels * kRows * kCols * kChannels;
  return kMacsPerLane * kernel.lanes * threads / seconds;
}

}  // namespace bevloc::bench
