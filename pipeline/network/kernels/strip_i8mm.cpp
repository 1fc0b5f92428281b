// Strip kernels for arm64 with the dot product of signed and unsigned bytes (FEAT_I8MM, Armv8.6).
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __aarch64__
#include <cstring>
#include <type_traits>

#include <arm_neon.h>

#pragma GCC target("arch=armv8.2-a+i8mm")

namespace bevloc::nn {
namespace {

struct Isa {
  static constexpr int kInputOffset = 0;
  using Input = uint8x16_t;

  static Input input(uint8x16_t bytes) { return bytes; }
  template <int kLane>
  static int32x4_t dot(int32x4_t sum, int8x16_t weights, Input input) {
    return vsudotq_laneq_s32(sum, weights, input, kLane);
  }
};

#include "pipeline/network/kernels/strip_body_neon.h"

}  // namespace

const KernelSet kI8mmKernels = neon_kernels("NEON-I8MM");

}  // namespace bevloc::nn
#endif
