// Parts of the strip kernels for arm64. Include it inside an anonymous namespace, after
// "#pragma GCC target" has selected an instruction set.
//
// A kernel divides a strip into tiles of a few pixels and all channels of a group. The sums of a
// tile stay in registers. A register of input is loaded once for all channels, and a register of
// weights once for all pixels of the tile.

constexpr int kBytesPerWord = 4;
constexpr int kRegisterLanes = 4;
constexpr int kBytesPerRegister = kBytesPerWord * kRegisterLanes;

/// Moves on to the weights after the next kRegisters registers.
template <int kRegisters>
[[gnu::always_inline]] inline void pass(const int8_t*& weights) {
  weights += kRegisters * kBytesPerRegister;
  // Otherwise the compiler loads the weights of many words first and has no registers for the sums.
  asm("" : "+r"(weights));
}

/// Loads the next two or three registers of weights.
template <int kRegisters>
[[gnu::always_inline]] inline auto next_weights(const int8_t*& weights) {
  if constexpr (kRegisters == 3) {
    const int8x16x3_t three = vld1q_s8_x3(weights);
    pass<3>(weights);
    return three;
  } else {
    const int8x16x2_t pair = vld1q_s8_x2(weights);
    pass<2>(weights);
    return pair;
  }
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
  for (unsigned left = static_cast<unsigned>(words) / 4; left > 0; --left) {
    add.template operator()<4>(line);
    line += 4 * kBytesPerWord;
  }
  if ((words & 2) != 0) {
    add.template operator()<2>(line);
    line += 2 * kBytesPerWord;
  }
  if ((words & 1) != 0) add.template operator()<1>(line);
}

/// Computes the pixels from `first` on, in as few tiles of at most kPixels as possible. All tiles
/// have about the same size, because the cost of a small tile is mostly that of its weights.
/// Isa::sum_tile(strip, first) computes one tile, for kRegisters * kRegisterLanes channels.
template <typename Isa, int kRegisters, int kPixels>
[[gnu::always_inline]] inline void sum_from(const KernelStrip& strip, int first) {
  constexpr int kNextSize = std::max(kPixels - Isa::kPixelsTogether, 1);
  const auto is_too_large = [&strip](int begin) {
    const int left = strip.pixels - begin;
    const int tiles = (left + kPixels - 1) / kPixels;
    return left < kPixels || (kPixels > 1 && left <= tiles * kNextSize);
  };
  for (; !is_too_large(first); first += kPixels) {
    Isa::template sum_tile<kRegisters, kPixels>(strip, first);
  }
  if constexpr (kPixels > 1) {
    if (first < strip.pixels) sum_from<Isa, kRegisters, kNextSize>(strip, first);
  }
}

template <typename Isa, int kRegisters, int kPixels>
void sum_strip(const KernelStrip& strip) {
  // A copy, because the compiler must assume that writing the sums changes `strip`.
  const KernelStrip own = strip;
  sum_from<Isa, kRegisters, kPixels>(own, 0);
}

/// The kernels for groups of 8, 16 and 24 channels. The sums of a tile, its input and a word's
/// weights almost fill the 32 registers.
template <typename Isa>
constexpr KernelSet neon_kernels(const char* name) {
  return {.name = name,
          .lanes = 8,
          .kernels = {{},
                      {sum_strip<Isa, 2, 10>, nullptr},
                      {sum_strip<Isa, 4, 6>, nullptr},
                      {sum_strip<Isa, 6, 4>, nullptr}},
          .step_words = Isa::kStepWords,
          .takes_signed = Isa::kTakesSigned};
}
