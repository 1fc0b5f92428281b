// Strip kernels for AVX512-VNNI, which sums four exact products of bytes per lane.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __x86_64__
#include <cstring>

#include <immintrin.h>

#pragma GCC target("avx512f,avx512bw,avx512vl,avx512vnni")

namespace bevloc::nn {
namespace {

struct Isa {
  static constexpr int kLanes = 16;
  using Vector = __m512i;
  using HalfVector = __m256i;

  static Vector load(const int32_t* from) { return _mm512_loadu_si512(from); }
  static HalfVector half_load(const int32_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  }
  static Vector broadcast(const uint8_t* word) {
    int32_t bytes = 0;
    std::memcpy(&bytes, word, sizeof(bytes));
    return _mm512_set1_epi32(bytes);
  }
  static Vector dot(Vector sum, Vector input, const int8_t* weights) {
    return _mm512_dpbusd_epi32(sum, input, _mm512_loadu_si512(weights));
  }
  static HalfVector half_dot(HalfVector sum, Vector input, const int8_t* weights) {
    return _mm256_dpbusd_epi32(sum, _mm512_castsi512_si256(input),
                               _mm256_loadu_si256(reinterpret_cast<const __m256i*>(weights)));
  }
  static void store(int32_t* sums, Vector sum) { _mm512_storeu_si512(sums, sum); }
  static void half_store(int32_t* sums, HalfVector sum) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums), sum);
  }
};

#include "pipeline/network/kernels/strip_body.h"

}  // namespace

const KernelSet kAvx512VnniKernels{
    .name = "AVX512-VNNI",
    .lanes = Isa::kLanes,
    .kernels = {{nullptr, sum_strip<Isa, 0, true, 8>},
                {sum_strip<Isa, 1, false, 10>, sum_strip<Isa, 1, true, 10>},
                {sum_strip<Isa, 2, false, 10>, sum_strip<Isa, 2, true, 8>},
                {sum_strip<Isa, 3, false, 8>, nullptr}}};

}  // namespace bevloc::nn
#endif
