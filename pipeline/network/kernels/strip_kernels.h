// The innermost loops of an int8 convolution, one set of kernels per instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/network/kernels/cpu_isa.h"

namespace bevloc::nn {

/// Input and output of a kernel: one output row of one group of output channels. A kernel computes
///   sums[p][lane] = start[lane]
///       + sum over rows r and bytes b of
///         lines[r][p * pixel_step + b] * weights[r][b][lane].
/// The bytes of the lines are unsigned, or signed if KernelSet::takes_signed.
/// A word is four bytes of input. A step is the one or two words that an instruction multiplies; it
/// needs one weight for each byte of the step and each lane. So weights are stored as
/// [rows][steps][lanes][bytes of a step]. If the words of a line do not fill its last step, the
/// weights of the missing word are 0.
struct KernelStrip {
  const uint8_t* const* lines = nullptr;  ///< `rows` padded input rows, channel last
  int rows = 0;
  int words = 0;                  ///< words of each line that contribute to one pixel
  std::ptrdiff_t pixel_step = 0;  ///< bytes in a line from one pixel's input to the next pixel's
  const int8_t* weights = nullptr;
  const int32_t* start = nullptr;  ///< initial value of the sum, by lane
  int pixels = 0;
  int32_t* sums = nullptr;
  std::ptrdiff_t sums_step = 0;  ///< elements in `sums` from one pixel to the next
};

using StripKernel = void (*)(const KernelStrip&);

/// The kernels of one instruction set. Each kernel computes a group of output channels of a certain
/// width.
struct KernelSet {
  static constexpr int kMostVectors = 3;

  const char* name = "";
  int lanes = 0;  ///< channels per vector
  /// kernels[n][0] computes n whole vectors, kernels[n][1] also a vector of half the lanes. It is
  /// null where there is no such kernel.
  StripKernel kernels[kMostVectors + 1][2] = {};
  /// The largest absolute weight with which no intermediate sum saturates.
  int largest_weight = 127;
  int step_words = 1;         ///< words in a step: 1 or 2
  bool takes_signed = false;  ///< whether the bytes of the input are signed
};

/// All sets that this CPU supports, the fastest first. The last one is plain C++.
std::span<const KernelSet* const> kernel_sets();

/// The fastest set that the cap allows.
const KernelSet& kernel_set(IsaCap cap);

}  // namespace bevloc::nn
