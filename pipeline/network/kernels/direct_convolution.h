// An int8 convolution of channel-last images, row by row, in exact integers.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "common/cache_line_allocator.h"
#include "pipeline/network/kernels/requantize.h"
#include "pipeline/network/kernels/strip_kernels.h"
#include "pipeline/network/program.h"

namespace bevloc::nn {

/// How the input lies in memory: [n, h, w, c], or [n, c, h, w] with few channels.
enum class ChannelOrder { kLast, kPlanes };

/// Weights are packed when it is made; run() allocates nothing. Thread safe: threads that run at
/// the same time do different rows, each with a scratchpad of its own.
///
/// Residual and output are dense [n, h, w, c]. The residual may be the output's own memory
/// if their elements have one width.
class DirectConvolution {
 public:
  /// Of an input in planes.
  static constexpr int kMostPlanes = 4;

  /// Whether a step is one that this class computes with these kernels: int8 weights that cannot
  /// saturate, 8-bit input, one group, no dilation.
  static bool can_run(const ConvStep& step, const Value& input, const KernelSet& kernels);

  DirectConvolution(const ConvStep& step, const Value& input, const Value& output,
                    const Value* residual, const KernelSet& kernels,
                    ChannelOrder order = ChannelOrder::kLast);

  /// Rows of all images together.
  int rows() const { return images_ * out_rows_; }
  size_t scratch_bytes() const;

  /// Computes the rows [begin, end). The scratchpad is best begun on a cache line.
  void run(const std::byte* input, const std::byte* residual, std::byte* output, int begin, int end,
           std::byte* scratch) const;

 private:
  /// Output channels that one kernel computes together.
  struct Group {
    StripKernel kernel = nullptr;
    int first_channel = 0;
    int lanes = 0;
    CacheLineVector<int8_t> weights;
  };
  class Lines;

  void make_groups(const ConvStep& step, const KernelSet& kernels);
  Group make_group(const ConvStep& step, StripKernel kernel, int first_channel, int lanes) const;
  bool reads_in_place() const;
  size_t line_bytes() const;

  ChannelOrder order_ = ChannelOrder::kLast;
  int images_ = 0;
  int in_rows_ = 0;
  int in_cols_ = 0;
  int in_channels_ = 0;
  int line_channels_ = 0;  ///< in_channels_, rounded up to whole words
  int out_rows_ = 0;
  int out_cols_ = 0;
  int kernel_rows_ = 0;
  int kernel_cols_ = 0;
  int stride_rows_ = 0;
  int stride_cols_ = 0;
  int pad_top_ = 0;
  int pad_left_ = 0;
  bool is_signed_ = false;
  int sums_per_pixel_ = 0;
  CacheLineVector<int32_t> starts_;  ///< of the sums, by lane
  std::vector<Group> groups_;
  Requantizer requantizer_;
  Requantize requantize_ = nullptr;
};

}  // namespace bevloc::nn
