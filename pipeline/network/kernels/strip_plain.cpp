// Strip kernels in plain C++: the reference that all other kernels must equal.
#include <algorithm>

#include "pipeline/network/kernels/strip_kernels_by_isa.h"

namespace bevloc::nn {
namespace {

constexpr int kLanes = 8;

template <int kVectors>
void sum_strip(const KernelStrip& strip) {
  constexpr int kGroup = kVectors * kLanes;
  for (int p = 0; p < strip.pixels; ++p) {
    int32_t sums[kGroup];
    std::copy_n(strip.start, kGroup, sums);
    const int8_t* weights = strip.weights;
    for (int row = 0; row < strip.rows; ++row) {
      const uint8_t* const input = strip.lines[row] + p * strip.pixel_step;
      for (int word = 0; word < strip.words; ++word, weights += 4 * kGroup) {
        for (int lane = 0; lane < kGroup; ++lane) {
          for (int b = 0; b < 4; ++b) sums[lane] += input[4 * word + b] * weights[4 * lane + b];
        }
      }
    }
    for (int lane = 0; lane < kGroup; ++lane) strip.sums[p * strip.sums_step + lane] = sums[lane];
  }
}

}  // namespace

const KernelSet kPlainKernels{
    .name = "plain",
    .lanes = kLanes,
    .kernels = {{}, {sum_strip<1>, nullptr}, {sum_strip<2>, nullptr}, {sum_strip<3>, nullptr}}};

}  // namespace bevloc::nn
