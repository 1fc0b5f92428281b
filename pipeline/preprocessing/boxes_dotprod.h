// Box sums for formats with three channels at each pixel. Include it after blocks_dotprod.h.

/// Adds to `sums` the weighted samples of the box of a pixel. The weights sum to 2^16.
/// place.samples<row, group>() returns the samples of four columns for each channel.
template <int kTaps, typename Place>
[[gnu::always_inline]] inline Sums box_sums(const Place& place, const RemapBlocks& blocks,
                                            size_t block, int pixel, Sums sums) {
  constexpr int kSlots = RemapBlocks::slots(kTaps);
  const uint8x16_t weights = load_weights<kSlots>(blocks, block, pixel);
  const uint32x4_t words = vreinterpretq_u32_u8(weights);
  const uint8x16_t cols[2] = {vreinterpretq_u8_u32(vdupq_laneq_u32(words, 0)),
                              vreinterpretq_u8_u32(vdupq_laneq_u32(words, kSlots / 4 - 1))};
  const uint16x8_t wide = kSlots == 4 ? vmovl_u8(vext_u8(vget_low_u8(weights), vdup_n_u8(0), 4))
                                      : vmovl_high_u8(weights);
  const uint32x4_t rows[2] = {vmovl_u16(vget_low_u16(wide)), vmovl_high_u16(wide)};
  repeat<kTaps>([&](auto row) __attribute__((always_inline)) {
    Sums line = vdotq_u32(vdupq_n_u32(0), place.template samples<row(), 0>(), cols[0]);
    if constexpr (kSlots == 8) {
      line = vdotq_u32(line, place.template samples<row(), 1>(), cols[1]);
    }
    sums = add_line<row()>(sums, line, rows);
  });
  return sums;
}
