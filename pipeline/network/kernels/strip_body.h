// Computes the sums of a strip, tile by tile. The source file of each instruction set includes it
// inside an anonymous namespace, after selecting that set and defining a struct `Isa` with vector
// types and operations.
//
// A tile has a few pixels and all channels of a group; its sums stay in registers. Each word of the
// input is broadcast once and used for all channels. Each vector of weights is loaded once and used
// for all pixels.

/// Computes the tile of kPixels pixels from pixel `first` on. If kHalf, a vector of half the lanes
/// follows the kVectors whole ones.
template <typename Isa, int kVectors, bool kHalf, int kPixels>
inline void sum_tile(const KernelStrip& strip, int first) {
  constexpr int kLanes = kVectors * Isa::kLanes + (kHalf ? Isa::kLanes / 2 : 0);
  typename Isa::Vector whole[kPixels][kVectors == 0 ? 1 : kVectors];
  typename Isa::HalfVector half[kPixels];
#pragma GCC unroll 16
  for (int p = 0; p < kPixels; ++p) {
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) whole[p][v] = Isa::load(strip.start + Isa::kLanes * v);
    if constexpr (kHalf) half[p] = Isa::half_load(strip.start + Isa::kLanes * kVectors);
  }
  const int8_t* weights = strip.weights;
  for (int row = 0; row < strip.rows; ++row) {
    const uint8_t* line = strip.lines[row] + first * strip.pixel_step;
    for (int word = 0; word < strip.words; ++word, line += 4, weights += 4 * kLanes) {
#pragma GCC unroll 16
      for (int p = 0; p < kPixels; ++p) {
        const typename Isa::Vector input = Isa::broadcast(line + p * strip.pixel_step);
#pragma GCC unroll 4
        for (int v = 0; v < kVectors; ++v) {
          whole[p][v] = Isa::dot(whole[p][v], input, weights + 4 * Isa::kLanes * v);
        }
        if constexpr (kHalf) {
          half[p] = Isa::half_dot(half[p], input, weights + 4 * Isa::kLanes * kVectors);
        }
      }
    }
  }
#pragma GCC unroll 16
  for (int p = 0; p < kPixels; ++p) {
    int32_t* const sums = strip.sums + (first + p) * strip.sums_step;
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) Isa::store(sums + Isa::kLanes * v, whole[p][v]);
    if constexpr (kHalf) Isa::half_store(sums + Isa::kLanes * kVectors, half[p]);
  }
}

/// Computes the pixels from `first` on: in tiles of kPixels, then of half as many, and so on.
template <typename Isa, int kVectors, bool kHalf, int kPixels>
inline void sum_from(const KernelStrip& strip, int first) {
  for (; first + kPixels <= strip.pixels; first += kPixels) {
    sum_tile<Isa, kVectors, kHalf, kPixels>(strip, first);
  }
  if constexpr (kPixels > 1) {
    if (first < strip.pixels) sum_from<Isa, kVectors, kHalf, kPixels / 2>(strip, first);
  }
}

template <typename Isa, int kVectors, bool kHalf, int kPixels>
void sum_strip(const KernelStrip& strip) {
  sum_from<Isa, kVectors, kHalf, kPixels>(strip, 0);
}
