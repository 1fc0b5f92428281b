// Tasks of our own where oneDNN is slower: int8 convolutions with few channels, and copies of their
// activations. All of them work on dense channel-last buffers.
#pragma once

#include "pipeline/network/engine/task.h"
#include "pipeline/network/kernels/direct_convolution.h"

namespace bevloc::nn::onednn {

class DirectConvolutionTask : public OwnTask {
 public:
  /// `residual` is a buffer, or -1 for none. The number of threads is that of OpenMP at
  /// construction.
  DirectConvolutionTask(DirectConvolution convolution, int input, int residual, int output);

  void bind(std::span<const PlacedBuffer> buffers, const dnnl::memory& scratchpad) override;
  void run(dnnl_stream_t stream) override;

 private:
  DirectConvolution convolution_;
  int residual_;
  size_t scratch_step_;
  CacheLineVector<std::byte> scratch_;  ///< scratch_step_ bytes for each thread
  const std::byte* added_ = nullptr;
};

/// Doubles the number of rows and columns by repeating each pixel.
class NearestUpsampleTask : public OwnTask {
 public:
  NearestUpsampleTask(const Value& input, int from, int to);

  void run(dnnl_stream_t stream) override;

 private:
  int rows_;
  size_t cols_;
  size_t pixel_bytes_;
};

/// Copies floats from channel-last to channel-first order.
class ExportTask : public OwnTask {
 public:
  ExportTask(const Value& value, int from, int to);

  void run(dnnl_stream_t stream) override;

 private:
  int images_;
  int channels_;
  int cells_;
};

}  // namespace bevloc::nn::onednn
