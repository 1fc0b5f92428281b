// Eight floats or integers in AVX2 registers. Include it inside an anonymous namespace, after
// `#pragma GCC target` has selected AVX2.

/// Loads fill the lanes from `count` on with 0, and stores leave the memory of these lanes
/// unchanged. Stores to 8-bit elements round to nearest even and saturate.
struct Lanes {
  static constexpr int kLanes = 8;

  static __m256i load(const int32_t* from, int count) {
    alignas(32) int32_t lanes[kLanes] = {};
    if (count == kLanes) return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    std::memcpy(lanes, from, static_cast<size_t>(count) * sizeof(int32_t));
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(lanes));
  }
  static __m256 load(const float* from, int count) {
    alignas(32) float lanes[kLanes] = {};
    if (count == kLanes) return _mm256_loadu_ps(from);
    std::memcpy(lanes, from, static_cast<size_t>(count) * sizeof(float));
    return _mm256_load_ps(lanes);
  }
  static __m256 load_as_float(const float* from, int count) { return load(from, count); }
  static __m256 load_as_float(const uint8_t* from, int count) {
    return to_float(_mm256_cvtepu8_epi32(load_bytes(from, count)));
  }
  static __m256 load_as_float(const int8_t* from, int count) {
    return to_float(_mm256_cvtepi8_epi32(load_bytes(from, count)));
  }

  static __m256 all(float value) { return _mm256_set1_ps(value); }
  static __m256 sum(__m256 a, __m256 b) { return _mm256_add_ps(a, b); }
  static __m256 product(__m256 a, __m256 b) { return _mm256_mul_ps(a, b); }
  static __m256 larger(__m256 a, __m256 b) { return _mm256_max_ps(a, b); }
  static __m256 to_float(__m256i lanes) { return _mm256_cvtepi32_ps(lanes); }

  static void store(__m256 lanes, float* to, int count) {
    if (count == kLanes) return _mm256_storeu_ps(to, lanes);
    alignas(32) float buffer[kLanes];
    _mm256_store_ps(buffer, lanes);
    std::memcpy(to, buffer, static_cast<size_t>(count) * sizeof(float));
  }
  static void store(__m256 lanes, uint8_t* to, int count) {
    const __m128i words = rounded_to_words(lanes);
    store_bytes(_mm_packus_epi16(words, words), to, count);
  }
  static void store(__m256 lanes, int8_t* to, int count) {
    const __m128i words = rounded_to_words(lanes);
    store_bytes(_mm_packs_epi16(words, words), to, count);
  }

 private:
  static __m128i load_bytes(const void* from, int count) {
    int64_t bytes = 0;
    if (count == kLanes) {
      std::memcpy(&bytes, from, kLanes);
    } else {
      std::memcpy(&bytes, from, static_cast<size_t>(count));
    }
    return _mm_cvtsi64_si128(bytes);
  }
  static void store_bytes(__m128i lanes, void* to, int count) {
    const int64_t bytes = _mm_cvtsi128_si64(lanes);
    if (count == kLanes) {
      std::memcpy(to, &bytes, kLanes);
    } else {
      std::memcpy(to, &bytes, static_cast<size_t>(count));
    }
  }
  static __m128i rounded_to_words(__m256 lanes) {
    const __m256i whole = _mm256_cvtps_epi32(lanes);
    return _mm_packs_epi32(_mm256_castsi256_si128(whole), _mm256_extracti128_si256(whole, 1));
  }
};
