// Strip kernels for AVX2. AVX2 sums pairs of products in 16 bits, which saturate if the weights are
// too large.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __x86_64__
#include <cstring>

#include <immintrin.h>

#pragma GCC target("avx2")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/strip_vectors_256.h"

struct Isa : Vectors256 {
  static Vector dot(Vector sum, Vector input, const int8_t* weights) {
    const Vector pairs = _mm256_maddubs_epi16(input, load(weights));
    return _mm256_add_epi32(sum, _mm256_madd_epi16(pairs, _mm256_set1_epi16(1)));
  }
};

#include "pipeline/network/kernels/strip_body.h"

}  // namespace

const KernelSet kAvx2Kernels{.name = "AVX2",
                             .lanes = Isa::kLanes,
                             .kernels = {{},
                                         {sum_strip<Isa, 1, false, 8>, nullptr},
                                         {sum_strip<Isa, 2, false, 4>, nullptr},
                                         {sum_strip<Isa, 3, false, 2>, nullptr}},
                             .largest_weight = 64};

}  // namespace bevloc::nn
#endif
