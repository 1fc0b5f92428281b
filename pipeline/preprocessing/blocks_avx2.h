// Parts of the AVX2 kernels. Include it inside a namespace, after "#pragma GCC target("avx2")" and
// block_shapes.h.
//
// A register contains a pair of pixels, i and i + 4 of a block, one in each 128-bit half. A half
// contains the channels one after the other: four bytes, four words or one 32-bit sum for each
// channel.

constexpr int kPairs = kPixels / 2;
constexpr int kNone = -1;

/// Control of _mm256_shuffle_epi8: byte i of half h becomes byte source(h, i) of the same half, or
/// 0 for kNone.
struct Shuffle {
  alignas(32) int8_t bytes[32];

  template <typename Source>
  explicit constexpr Shuffle(const Source& source) : bytes() {
    for (int i = 0; i < 32; ++i) bytes[i] = static_cast<int8_t>(source(i / 16, i % 16));
  }
  __m256i load() const { return _mm256_load_si256(reinterpret_cast<const __m256i*>(bytes)); }
  __m256i operator()(__m256i from) const { return _mm256_shuffle_epi8(from, load()); }
};

inline __m128i load_16(const uint8_t* from) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
}
inline __m128i load_8(const uint8_t* from) {
  return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
}
inline __m128i load_4(const uint8_t* from) {
  return _mm_loadu_si32(from);
}

/// Samples minus 128 as signed bytes, so that the sum of two products weight * sample fits into 16
/// bits.
inline __m256i centred(__m256i samples) {
  return _mm256_xor_si256(samples, _mm256_set1_epi8(-128));
}

inline __m256i load_positions(const std::vector<uint16_t>& positions, size_t block) {
  const uint16_t* const first = positions.data() + kPixels * block;
  return _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(first)));
}

inline __m256i times(__m256i positions, std::ptrdiff_t factor) {
  return _mm256_mullo_epi32(positions, _mm256_set1_epi32(static_cast<int32_t>(factor)));
}

/// For each pixel of a block: offset in bytes of its first sample from the first sample of the
/// plane.
struct Distances {
  alignas(32) int32_t bytes[kPixels];

  Distances(__m256i rows, std::ptrdiff_t stride_bytes, __m256i in_row_bytes) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(bytes),
                       _mm256_add_epi32(times(rows, stride_bytes), in_row_bytes));
  }
  std::ptrdiff_t operator[](int pixel) const { return bytes[pixel]; }
};

/// The distances for a format with all channels of a pixel in `pixel_bytes` adjacent bytes.
inline Distances packed_distances(const RemapBlocks& blocks, size_t block,
                                  std::ptrdiff_t stride_bytes, int pixel_bytes) {
  return {load_positions(blocks.first_row, block), stride_bytes,
          times(load_positions(blocks.first_col, block), pixel_bytes)};
}

/// Loads 16 bytes for each pixel of a pair.
inline __m256i load_pair(const uint8_t* first, const Distances& place, int pair) {
  return _mm256_set_m128i(load_16(first + place[pair + kPairs]), load_16(first + place[pair]));
}

/// Loads the weights of a pair. col_weight() and row_weight() select from them.
template <int kSlots>
__m256i load_weights(const RemapBlocks& blocks, size_t block, int pair) {
  const uint8_t* const first = blocks.weights.data() + 4 * kSlots * (kPairs * block + pair);
  if constexpr (kSlots == 4) return _mm256_broadcastsi128_si256(load_16(first));
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(first));
}

/// Position of a column weight within a half.
template <int kSlots>
constexpr int col_weight(int half, int slot) {
  return slot + (kSlots == 4 ? 8 * half : 0);
}
/// Copies the weight of a row to all words of a half.
template <int kSlots>
constexpr Shuffle row_weight(int row) {
  return Shuffle([row](int half, int i) {
    return i % 2 == 0 ? kSlots + col_weight<kSlots>(half, row) : kNone;
  });
}

/// The array {make(0), make(1), ..., make(kCount - 1)}.
template <int kCount, typename Make>
constexpr auto shuffles(const Make& make) {
  return [&make]<int... kIndex>(std::integer_sequence<int, kIndex...>) {
    return std::array{make(kIndex)...};
  }
  (std::make_integer_sequence<int, kCount>());
}

/// Writes a block to the three planes. Each half of `bytes` has red, green and blue of four pixels.
inline void store_block(__m256i bytes, int8_t* planes) {
  const __m256i channels =
      _mm256_permutevar8x32_epi32(bytes, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7));
  const __m128i red_green = _mm256_castsi256_si128(channels);
  const __m128i blue = _mm256_extracti128_si256(channels, 1);
  _mm_storel_epi64(reinterpret_cast<__m128i*>(planes), red_green);
  _mm_storeh_pd(reinterpret_cast<double*>(planes + kNetworkPixels), _mm_castsi128_pd(red_green));
  _mm_storel_epi64(reinterpret_cast<__m128i*>(planes + 2 * kNetworkPixels), blue);
}

/// Transposes four sums for each of eight pixels to eight sums of each kind.
struct SumsByKind {
  __m256i kinds[4];

  explicit SumsByKind(const __m256i (&pairs)[kPairs]) {
    const __m256i low01 = _mm256_unpacklo_epi32(pairs[0], pairs[1]);
    const __m256i low23 = _mm256_unpacklo_epi32(pairs[2], pairs[3]);
    const __m256i high01 = _mm256_unpackhi_epi32(pairs[0], pairs[1]);
    const __m256i high23 = _mm256_unpackhi_epi32(pairs[2], pairs[3]);
    kinds[0] = _mm256_unpacklo_epi64(low01, low23);
    kinds[1] = _mm256_unpackhi_epi64(low01, low23);
    kinds[2] = _mm256_unpacklo_epi64(high01, high23);
    kinds[3] = _mm256_unpackhi_epi64(high01, high23);
  }
};

/// Converts to signed bytes with saturation.
inline __m256i to_bytes(__m256i red, __m256i green, __m256i blue) {
  return _mm256_packs_epi16(_mm256_packs_epi32(red, green), _mm256_packs_epi32(blue, blue));
}
