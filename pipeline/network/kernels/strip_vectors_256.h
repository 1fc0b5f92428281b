// Operations on 256-bit vectors that the AVX2 and AVX-VNNI strip kernels share. Include it inside
// an anonymous namespace, after `#pragma GCC target` has selected the instruction set.

struct Vectors256 {
  static constexpr int kLanes = 8;
  using Vector = __m256i;
  using HalfVector = __m128i;

  static Vector load(const int32_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  }
  static Vector load(const int8_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  }
  static Vector broadcast(const uint8_t* word) {
    int32_t bytes = 0;
    std::memcpy(&bytes, word, sizeof(bytes));
    return _mm256_set1_epi32(bytes);
  }
  static void store(int32_t* sums, Vector sum) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums), sum);
  }
};
