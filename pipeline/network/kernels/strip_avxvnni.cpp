// Kernels for AVX-VNNI: those of AVX512-VNNI in vectors of 256 bits.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __x86_64__
#include <cstring>

#include <immintrin.h>

#pragma GCC target("avx2,avxvnni")

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
    return _mm256_dpbusd_avx_epi32(sum, input,
                                   _mm256_loadu_si256(reinterpret_cast<const __m256i*>(weights)));
  }
  static void store(int32_t* sums, Vector sum) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums), sum);
  }
};

#include "pipeline/network/kernels/strip_body.h"

}  // namespace

const KernelSet kAvxVnniKernels{.name = "AVX-VNNI",
                                .lanes = Isa::kLanes,
                                .kernels = {{},
                                            {sum_strip<Isa, 1, false, 8>, nullptr},
                                            {sum_strip<Isa, 2, false, 4>, nullptr},
                                            {sum_strip<Isa, 3, false, 4>, nullptr}}};

}  // namespace bevloc::nn
#endif
