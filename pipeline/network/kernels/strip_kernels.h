// The innermost loops of an int8 convolution, once for each instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/network/cpu_isa.h"

namespace bevloc::nn {

/// One row of one group of output channels: what a kernel reads and writes.
///   sums[p][lane] = start[lane]
///       + sum over rows r, bytes b of lines[r][p * pixel_step + b] * weights[r][b][lane]
/// where weights lie as [rows][words][lanes][4]: four bytes of input (a word) meet four weights.
struct KernelStrip {
  const uint8_t* const* lines = nullptr;  ///< `rows` rows of the input, channel last, padded
  int rows = 0;
  int words = 0;                  ///< a pixel's input in each line, in units of four bytes
  std::ptrdiff_t pixel_step = 0;  ///< bytes from one pixel's input to the next one's
  const int8_t* weights = nullptr;
  const int32_t* start = nullptr;
  int pixels = 0;
  int32_t* sums = nullptr;
  std::ptrdiff_t sums_step = 0;  ///< elements from one pixel's sums to the next one's
};

using StripKernel = void (*)(const KernelStrip&);

/// The kernels of one instruction set. A group of output channels is as wide as one to three
/// vectors; `narrow` vectors are there for what is left over, and null where all are alike.
struct KernelSet {
  static constexpr int kMostVectors = 3;

  const char* name = "";
  int lanes = 0;  ///< of a vector
  /// By number of vectors, from 1 on; [n][1] has one vector of half the lanes besides.
  StripKernel kernels[kMostVectors + 1][2] = {};
  /// The largest weight with which no intermediate sum saturates.
  int largest_weight = 127;
};

/// Every set that this CPU can run, the fastest first; the last one is plain C++.
std::span<const KernelSet* const> kernel_sets();

/// The fastest one under the cap.
const KernelSet& kernel_set(IsaCap cap);

}  // namespace bevloc::nn
