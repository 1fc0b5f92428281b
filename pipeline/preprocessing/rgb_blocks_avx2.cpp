#include "pipeline/preprocessing/block_kernels.h"

#ifdef __x86_64__
#include <array>
#include <type_traits>
#include <utility>

#include <immintrin.h>

#pragma GCC target("avx2")

namespace bevloc {
namespace {

#include "pipeline/preprocessing/block_shapes.h"
#include "pipeline/preprocessing/blocks_avx2.h"
#include "pipeline/preprocessing/boxes_avx2.h"

struct RgbSource {
  const uint8_t* data;
  std::ptrdiff_t stride_bytes;

  using Place = Distances;
  Place place(const RemapBlocks& blocks, size_t block) const {
    return packed_distances(blocks, block, stride_bytes, 3);
  }

  template <int kTaps>
  void prefetch(const Place& place) const {
    prefetch_below<kTaps, 3>(data + place[0], stride_bytes);
  }

  template <int kGroup>
  __m256i samples(const Place& place, int pair, int row) const {
    static constexpr Shuffle kByChannel(
        [](int, int i) { return i < 12 ? 3 * (i % 4) + i / 4 : kNone; });
    return kByChannel(load_pair(data + row * stride_bytes + 12 * kGroup, place, pair));
  }
};

template <int kTaps, int kParts>
void remap_blocks(const RgbView& image, const RemapBlocks& blocks, int8_t* planes) {
  constexpr int kSumBits = 2 * RemapTable::kWeightBits;
  static constexpr Shuffle kByChannel([](int, int i) { return 4 * (i % 4) + i / 4; });
  const __m256i half = _mm256_set1_epi32(1 << (kSumBits - 1));
  const RgbSource source{image.data, image.stride_bytes};
  for (size_t block = 0; block < blocks.index.size(); ++block) {
    __m256i means[kPairs] = {half, half, half, half};
    for_each_part<kParts>(
        block, [&](size_t part) __attribute__((always_inline)) {
          const Distances place = source.place(blocks, part);
          source.prefetch<kTaps>(place);
          for (int pair = 0; pair < kPairs; ++pair) {
            means[pair] = box_sums<kTaps>(source, place, blocks, part, pair, means[pair]);
          }
        });
    for (__m256i& mean : means) mean = _mm256_srai_epi32(mean, kSumBits);
    const __m256i bytes = _mm256_packs_epi16(_mm256_packs_epi32(means[0], means[1]),
                                             _mm256_packs_epi32(means[2], means[3]));
    store_block(kByChannel(bytes), planes + kPixels * blocks.index[block]);
  }
}

}  // namespace

BlockKernel<RgbView>* rgb_block_kernel(int taps) {
  return kernel_of_taps(taps, [](auto shape) -> BlockKernel<RgbView>* {
    return remap_blocks<shape.taps, shape.parts>;
  });
}

}  // namespace bevloc
#endif
