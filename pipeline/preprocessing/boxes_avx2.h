// Box sums for formats with three channels at each pixel. Include it after blocks_avx2.h.

/// Weighted sums over the boxes of a pair of centred samples, plus `start`. The weights sum to
/// 2^16. source.samples<group>(place, pair, row) returns the samples of four columns for each
/// channel.
template <int kTaps, typename Source>
[[gnu::always_inline]] inline __m256i box_sums(const Source& source,
                                               const typename Source::Place& place,
                                               const RemapBlocks& blocks, size_t block, int pair,
                                               __m256i start) {
  constexpr int kSlots = RemapBlocks::slots(kTaps);
  static constexpr Shuffle kCols[2] = {
      Shuffle([](int half, int i) { return col_weight<kSlots>(half, i % 4); }),
      Shuffle([](int half, int i) { return col_weight<kSlots>(half, kSlots - 4 + i % 4); })};
  static constexpr auto kRows = shuffles<kTaps>(row_weight<kSlots>);
  const __m256i weights = load_weights<kSlots>(blocks, block, pair);
  const __m256i cols[2] = {kCols[0](weights), kCols[1](weights)};
  __m256i sums = start;
#pragma GCC unroll 8
  for (int row = 0; row < kTaps; ++row) {
    __m256i line =
        _mm256_maddubs_epi16(cols[0], centred(source.template samples<0>(place, pair, row)));
    if constexpr (kSlots == 8) {
      const __m256i right = centred(source.template samples<1>(place, pair, row));
      line = _mm256_add_epi16(line, _mm256_maddubs_epi16(cols[1], right));
    }
    sums = _mm256_add_epi32(sums, _mm256_madd_epi16(line, kRows[row](weights)));
  }
  return sums;
}
