// Tasks of our own where oneDNN is slower: int8 convolutions of few channels, and what moves their
// elements. All on dense channel-last buffers.
#pragma once

#include "pipeline/network/kernels/direct_convolution.h"
#include "pipeline/network/onednn/task.h"

namespace bevloc::nn::onednn {

class DirectConvolutionTask : public Task {
 public:
  /// A residual of -1 is none. Runs on as many OpenMP threads as are set when it is made.
  DirectConvolutionTask(DirectConvolution convolution, int input, int residual, int output);

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  DirectConvolution convolution_;
  int input_;
  int residual_;
  int output_;
  size_t scratch_step_;
  CacheLineVector<std::byte> scratch_;  ///< a piece for each thread
  const std::byte* from_ = nullptr;
  const std::byte* added_ = nullptr;
  std::byte* to_ = nullptr;
};

/// Each cell repeated twice along both axes.
class NearestUpsampleTask : public Task {
 public:
  NearestUpsampleTask(const Value& input, int from, int to);

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  int input_;
  int output_;
  int rows_;
  size_t cols_;
  size_t pixel_bytes_;
  const std::byte* from_ = nullptr;
  std::byte* to_ = nullptr;
};

/// Floats, channel last, to channel first.
class ExportTask : public Task {
 public:
  ExportTask(const Value& value, int from, int to);

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  int input_;
  int output_;
  int images_;
  int channels_;
  int cells_;
  const float* from_ = nullptr;
  float* to_ = nullptr;
};

}  // namespace bevloc::nn::onednn
