// Parts of the strip kernels for arm64. Include it inside an anonymous namespace, after
// "#pragma GCC target" has selected an instruction set.
//
// A kernel divides a strip into tiles of a few pixels and all channels of a group. The sums of a
// tile stay in registers. A register of input is loaded once for all channels, and a register of
// weights once for all pixels of the tile.

constexpr int kBytesPerWord = 4;
constexpr int kRegisterLanes = 4;
constexpr int kBytesPerRegister = kBytesPerWord * kRegisterLanes;

/// Loads two registers of weights and moves on to the next.
[[gnu::always_inline]] inline int8x16x2_t next_weights(const int8_t*& weights) {
  const int8x16x2_t pair = vld1q_s8_x2(weights);
  weights += 2 * kBytesPerRegister;
  // Otherwise the compiler loads the weights of many words first and has no registers for the sums.
  asm("" : "+r"(weights));
  return pair;
}

/// Loads one or two words. The bytes after them are 0.
template <int kWords>
inline uint8x8_t load_half(const uint8_t* line) {
  if constexpr (kWords == 2) return vld1_u8(line);
  uint32_t word = 0;
  std::memcpy(&word, line, sizeof(word));
  return vreinterpret_u8_u32(vset_lane_u32(word, vdup_n_u32(0), 0));
}

/// Calls `add` with a part of the line, and the number of its words as template argument: four
/// words as often as possible, then two and one.
template <typename Add>
[[gnu::always_inline]] inline void for_words(const uint8_t* line, int words, const Add& add) {
  for (int left = words / 4; left > 0; --left) {
    add.template operator()<4>(line);
    line += 4 * kBytesPerWord;
  }
  if ((words & 2) != 0) {
    add.template operator()<2>(line);
    line += 2 * kBytesPerWord;
  }
  if ((words & 1) != 0) add.template operator()<1>(line);
}

/// Computes the pixels from `first` on. As many as possible are computed in tiles of kPixels, the
/// rest in tiles of half that size, and so on. Isa::sum_tile(strip, first) computes one tile, for
/// kRegisters * kRegisterLanes channels.
template <typename Isa, int kRegisters, int kPixels>
[[gnu::always_inline]] inline void sum_from(const KernelStrip& strip, int first) {
  for (; first + kPixels <= strip.pixels; first += kPixels) {
    Isa::template sum_tile<kRegisters, kPixels>(strip, first);
  }
  if constexpr (kPixels > 1) {
    if (first < strip.pixels) sum_from<Isa, kRegisters, kPixels / 2>(strip, first);
  }
}

template <typename Isa, int kRegisters, int kPixels>
void sum_strip(const KernelStrip& strip) {
  sum_from<Isa, kRegisters, kPixels>(strip, 0);
}

/// The kernels for groups of 8, 16 and 24 channels. The sums of a tile and its input almost
/// fill the 32 registers.
template <typename Isa>
constexpr KernelSet neon_kernels(const char* name) {
  return {.name = name,
          .lanes = 8,
          .kernels = {{},
                      {sum_strip<Isa, 2, 10>, nullptr},
                      {sum_strip<Isa, 4, 6>, nullptr},
                      {sum_strip<Isa, 6, 4>, nullptr}},
          .step_words = Isa::kStepWords,
          .input_offset = Isa::kInputOffset};
}
