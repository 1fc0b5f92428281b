// Strip kernels for arm64 with the dot product of signed bytes (FEAT_DotProd, Armv8.2).
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __aarch64__
#include <cstring>
#include <type_traits>

#include <arm_neon.h>

#pragma GCC target("arch=armv8.2-a+dotprod")

namespace bevloc::nn {
namespace {

/// The instruction takes signed bytes. An XOR with 128 subtracts 128 from an unsigned byte.
struct Isa {
  static constexpr int kInputOffset = 128;
  using Input = int8x16_t;

  static Input input(uint8x16_t bytes) {
    return vreinterpretq_s8_u8(veorq_u8(bytes, vdupq_n_u8(kInputOffset)));
  }
  template <int kLane>
  static int32x4_t dot(int32x4_t sum, int8x16_t weights, Input input) {
    return vdotq_laneq_s32(sum, weights, input, kLane);
  }
};

#include "pipeline/network/kernels/strip_body_neon.h"

}  // namespace

const KernelSet kDotProductKernels = neon_kernels("NEON-DotProd");

}  // namespace bevloc::nn
#endif
