#include "pipeline/network/engine/direct_task.h"

#include <algorithm>

#include <omp.h>

#include "pipeline/network/engine/parallel_for.h"
#include "pipeline/network/kernels/nearest_upsample.h"

namespace bevloc::nn::onednn {
namespace {

/// Scratchpads have a multiple of this size, so that two threads never write to one cache line.
constexpr size_t kScratchUnit = 256;

}  // namespace

DirectConvolutionTask::DirectConvolutionTask(DirectConvolution convolution, int input, int residual,
                                             int output)
    : OwnTask(input, output),
      convolution_(std::move(convolution)),
      residual_(residual),
      scratch_step_((convolution_.scratch_bytes() / kScratchUnit + 1) * kScratchUnit),
      scratch_(scratch_step_ * static_cast<size_t>(omp_get_max_threads())) {}

void DirectConvolutionTask::bind(std::span<const PlacedBuffer> buffers,
                                 const dnnl::memory& scratchpad) {
  OwnTask::bind(buffers, scratchpad);
  added_ = residual_ < 0 ? nullptr : buffers[static_cast<size_t>(residual_)].data;
}

void DirectConvolutionTask::run(dnnl_stream_t) {
  const int rows = convolution_.rows();
  const int pieces = static_cast<int>(scratch_.size() / scratch_step_);
  parallel_for(pieces, [this, rows, pieces](int piece) {
    convolution_.run(from(), added_, to(), rows * piece / pieces, rows * (piece + 1) / pieces,
                     scratch_.data() + static_cast<size_t>(piece) * scratch_step_);
  });
}

NearestUpsampleTask::NearestUpsampleTask(const Value& input, int from, int to)
    : OwnTask(from, to),
      rows_(static_cast<int>(input.dims[0] * input.dims[2])),
      cols_(static_cast<size_t>(input.dims[3])),
      pixel_bytes_(static_cast<size_t>(input.dims[1]) * size_in_bytes(input.type)) {}

void NearestUpsampleTask::run(dnnl_stream_t) {
  parallel_for(rows_, [this](int row) {
    const auto begin = static_cast<size_t>(row);
    upsample_nearest(from(), cols_, pixel_bytes_, begin, begin + 1, to());
  });
}

ExportTask::ExportTask(const Value& value, int from, int to)
    : OwnTask(from, to),
      images_(static_cast<int>(value.dims[0])),
      channels_(static_cast<int>(value.dims[1])),
      cells_(static_cast<int>(value.dims[2] * value.dims[3])) {}

void ExportTask::run(dnnl_stream_t) {
  constexpr int kBlock = 64;  // cells whose elements fit into the first-level cache
  for (int image = 0; image < images_; ++image) {
    const size_t first = static_cast<size_t>(image) * channels_ * cells_;
    const float* const source = reinterpret_cast<const float*>(from()) + first;
    float* const target = reinterpret_cast<float*>(to()) + first;
    parallel_for((cells_ + kBlock - 1) / kBlock, [this, source, target](int block) {
      const int begin = block * kBlock;
      const int end = std::min(begin + kBlock, cells_);
      for (int c = 0; c < channels_; ++c) {
#pragma GCC unroll 8
        for (int i = begin; i < end; ++i) target[c * cells_ + i] = source[i * channels_ + c];
      }
    });
  }
}

}  // namespace bevloc::nn::onednn
