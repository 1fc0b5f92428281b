// Kernels for AVX2. Its products of bytes are summed in pairs of 16 bits, which saturate unless the
// weights are small.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __x86_64__
#include <cstring>

#include <immintrin.h>

#pragma GCC target("avx2")

namespace bevloc::nn {
namespace {

struct Isa {
  static constexpr int kLanes = 8;
  using Vector = __m256i;
  using HalfVector = __m128i;

  static Vector load(const int32_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  }
  static Vector broadcast(const uint8_t* word) {
    int32_t bytes = 0;
    std::memcpy(&bytes, word, sizeof(bytes));
    return _mm256_set1_epi32(bytes);
  }
  static Vector dot(Vector sum, Vector input, const int8_t* weights) {
    const Vector pairs =
        _mm256_maddubs_epi16(input, _mm256_loadu_si256(reinterpret_cast<const __m256i*>(weights)));
    return _mm256_add_epi32(sum, _mm256_madd_epi16(pairs, _mm256_set1_epi16(1)));
  }
  static void store(int32_t* sums, Vector sum) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums), sum);
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
