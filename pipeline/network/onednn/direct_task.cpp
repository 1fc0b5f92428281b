#include "pipeline/network/onednn/direct_task.h"

#include <algorithm>

#include <omp.h>

#include "pipeline/network/nearest_upsample.h"
#include "pipeline/network/onednn/parallel.h"

namespace bevloc::nn::onednn {
namespace {

/// Threads that write scratch must not share a cache line.
constexpr size_t kScratchUnit = 256;

}  // namespace

DirectConvolutionTask::DirectConvolutionTask(DirectConvolution convolution, int input, int residual,
                                             int output)
    : convolution_(std::move(convolution)),
      input_(input),
      residual_(residual),
      output_(output),
      scratch_step_((convolution_.scratch_bytes() / kScratchUnit + 1) * kScratchUnit),
      scratch_(scratch_step_ * static_cast<size_t>(omp_get_max_threads())) {}

void DirectConvolutionTask::bind(std::span<const PlacedBuffer> buffers, const dnnl::memory&) {
  from_ = buffers[static_cast<size_t>(input_)].data;
  added_ = residual_ < 0 ? nullptr : buffers[static_cast<size_t>(residual_)].data;
  to_ = buffers[static_cast<size_t>(output_)].data;
}

void DirectConvolutionTask::run(dnnl_stream_t) {
  const int rows = convolution_.rows();
  const int pieces = static_cast<int>(scratch_.size() / scratch_step_);
  for_each_turn(pieces, [this, rows, pieces](int piece) {
    convolution_.run(from_, added_, to_, rows * piece / pieces, rows * (piece + 1) / pieces,
                     scratch_.data() + static_cast<size_t>(piece) * scratch_step_);
  });
}

NearestUpsampleTask::NearestUpsampleTask(const Value& input, int from, int to)
    : input_(from),
      output_(to),
      rows_(static_cast<int>(input.dims[0] * input.dims[2])),
      cols_(static_cast<size_t>(input.dims[3])),
      pixel_bytes_(static_cast<size_t>(input.dims[1]) * size_in_bytes(input.type)) {}

void NearestUpsampleTask::bind(std::span<const PlacedBuffer> buffers, const dnnl::memory&) {
  from_ = buffers[static_cast<size_t>(input_)].data;
  to_ = buffers[static_cast<size_t>(output_)].data;
}

void NearestUpsampleTask::run(dnnl_stream_t) {
  for_each_turn(rows_, [this](int row) {
    const auto begin = static_cast<size_t>(row);
    upsample_nearest(from_, cols_, pixel_bytes_, begin, begin + 1, to_);
  });
}

ExportTask::ExportTask(const Value& value, int from, int to)
    : input_(from),
      output_(to),
      images_(static_cast<int>(value.dims[0])),
      channels_(static_cast<int>(value.dims[1])),
      cells_(static_cast<int>(value.dims[2] * value.dims[3])) {}

void ExportTask::bind(std::span<const PlacedBuffer> buffers, const dnnl::memory&) {
  from_ = reinterpret_cast<const float*>(buffers[static_cast<size_t>(input_)].data);
  to_ = reinterpret_cast<float*>(buffers[static_cast<size_t>(output_)].data);
}

void ExportTask::run(dnnl_stream_t) {
  constexpr int kBlock = 64;  // its cells stay in the first cache from channel to channel
  for (int image = 0; image < images_; ++image) {
    const float* const from = from_ + static_cast<size_t>(image) * channels_ * cells_;
    float* const to = to_ + static_cast<size_t>(image) * channels_ * cells_;
    for_each_turn((cells_ + kBlock - 1) / kBlock, [this, from, to](int block) {
      const int begin = block * kBlock;
      const int end = std::min(begin + kBlock, cells_);
      for (int c = 0; c < channels_; ++c) {
        for (int i = begin; i < end; ++i) to[c * cells_ + i] = from[i * channels_ + c];
      }
    });
  }
}

}  // namespace bevloc::nn::onednn
