// Strip kernels for AVX-VNNI: like AVX512-VNNI, with vectors of 256 bits.
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

#ifdef __x86_64__
#include <cstring>

#include <immintrin.h>

#pragma GCC target("avx2,avxvnni")

namespace bevloc::nn {
namespace {

#include "pipeline/network/kernels/strip_vectors_256.h"

struct Isa : Vectors256 {
  static Vector dot(Vector sum, Vector input, const int8_t* weights) {
    return _mm256_dpbusd_avx_epi32(sum, input, load(weights));
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
