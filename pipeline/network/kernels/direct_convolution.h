// An int8 convolution that sums exact integers, row by row, into a channel-last output.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "common/cache_line_allocator.h"
#include "pipeline/network/kernels/requantize.h"
#include "pipeline/network/kernels/strip_kernels.h"
#include "pipeline/network/model/program.h"

namespace bevloc::nn {

/// Memory layout of the input: [n, h, w, c], or [n, c, h, w] (with at most kMostPlanes channels).
enum class ChannelOrder { kLast, kPlanes };

/// The constructor packs the weights; run() does not allocate. run() is thread-safe if concurrent
/// calls compute different rows and have separate scratchpads.
///
/// Residual and output are dense [n, h, w, c]. The residual may be the memory of the output if
/// their elements have the same size.
class DirectConvolution {
 public:
  /// The largest number of channels for ChannelOrder::kPlanes.
  static constexpr int kMostPlanes = 4;

  /// Whether this class can compute the step with these kernels. It requires an 8-bit input, one
  /// group, no dilation, and int8 weights small enough that no intermediate sum saturates.
  static bool can_run(const ConvStep& step, const Value& input, const KernelSet& kernels);

  /// `residual` may be null.
  DirectConvolution(const ConvStep& step, const Value& input, const Value& output,
                    const Value* residual, const KernelSet& kernels,
                    ChannelOrder order = ChannelOrder::kLast);

  /// Output rows of all images together.
  int rows() const { return images_ * out_rows_; }
  size_t scratch_bytes() const;

  /// Computes the output rows [begin, end). `scratch` has scratch_bytes() bytes and should be
  /// aligned to a cache line. `residual` may be null.
  void run(const std::byte* input, const std::byte* residual, std::byte* output, int begin, int end,
           std::byte* scratch) const;

 private:
  /// Output channels that one call of a kernel computes.
  struct Group {
    StripKernel kernel = nullptr;
    int first_channel = 0;
    int lanes = 0;
    CacheLineVector<int8_t> weights;
  };
  class Lines;

  void make_groups(const ConvStep& step, const KernelSet& kernels);
  Group make_group(const ConvStep& step, const KernelSet& kernels, StripKernel kernel,
                   int first_channel, int lanes) const;
  bool reads_in_place() const;
  size_t line_bytes() const;

  ChannelOrder order_ = ChannelOrder::kLast;
  int images_ = 0;
  int in_rows_ = 0;
  int in_cols_ = 0;
  int in_channels_ = 0;
  int line_channels_ = 0;  ///< in_channels_, rounded up to a multiple of 4
  int out_rows_ = 0;
  int out_cols_ = 0;
  int kernel_rows_ = 0;
  int kernel_cols_ = 0;
  int stride_rows_ = 0;
  int stride_cols_ = 0;
  int pad_top_ = 0;
  int pad_left_ = 0;
  uint8_t flip_ = 0;  ///< XORed with each byte of input, to give the sign that the kernels take
  int sums_per_pixel_ = 0;
  CacheLineVector<int32_t> starts_;  ///< initial values of the sums, by channel
  std::vector<Group> groups_;
  Requantizer requantizer_;
  Requantize requantize_ = nullptr;
};

}  // namespace bevloc::nn
