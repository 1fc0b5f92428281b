#include "pipeline/preprocessing/block_kernels.h"

#ifdef __x86_64__
#include <array>
#include <type_traits>
#include <utility>

#include <immintrin.h>

#include "pipeline/preprocessing/yuv_colour.h"

#pragma GCC target("avx2")

namespace bevloc {
namespace {

#include "pipeline/preprocessing/block_shapes.h"
#include "pipeline/preprocessing/blocks_avx2.h"
#include "pipeline/preprocessing/boxes_avx2.h"

/// YUYV (kLuma = 0) or UYVY (kLuma = 1): eight pixels in sixteen bytes.
template <int kLuma>
class PackedSource {
 public:
  explicit PackedSource(const YuvLayout& image)
      : data_(image.y.data - kLuma), stride_bytes_(image.y.stride_bytes) {}

  using Place = Distances;
  Place place(const RemapBlocks& blocks, size_t block) const {
    return packed_distances(blocks, block, stride_bytes_, 2);
  }

  template <int kTaps>
  void prefetch(const Place& place) const {
    prefetch_below<kTaps, 2>(data_ + place[0], stride_bytes_);
  }

  template <int kGroup>
  __m256i samples(const Place& place, int pair, int row) const {
    static constexpr Shuffle kByChannel([](int, int i) {
      const int chroma = 4 * (i % 4 / 2) + 1 - kLuma;
      const int from[] = {2 * (i % 4) + kLuma, chroma, chroma + 2, kNone};
      return from[i / 4] == kNone ? kNone : 8 * kGroup + from[i / 4];
    });
    return kByChannel(load_pair(data_ + row * stride_bytes_, place, pair));
  }

 private:
  const uint8_t* data_;
  std::ptrdiff_t stride_bytes_;
};

/// Positions of the samples of a block, for formats with luma in a separate plane.
struct PlanarPlace {
  Distances luma;
  Distances chroma[2];  ///< distances for rows 0, 2, ... and for rows 1, 3, ... of the block
};

template <bool kHalvedRows>
PlanarPlace planar_place(const YuvLayout& image, const RemapBlocks& blocks, size_t block) {
  const __m256i rows = load_positions(blocks.first_row, block);
  const __m256i cols = load_positions(blocks.first_col, block);
  const auto chroma = [&](__m256i luma_rows) __attribute__((always_inline)) {
    const __m256i in_row = image.chroma_step == 2 ? cols : _mm256_srli_epi32(cols, 1);
    const __m256i chroma_rows = kHalvedRows ? _mm256_srli_epi32(luma_rows, 1) : luma_rows;
    return Distances(chroma_rows, image.u.stride_bytes, in_row);
  };
  return {Distances(rows, image.y.stride_bytes, cols),
          {chroma(rows), chroma(_mm256_add_epi32(rows, _mm256_set1_epi32(kHalvedRows ? 1 : 0)))}};
}

template <bool kHalvedRows>
std::ptrdiff_t chroma_row(int row) {
  return kHalvedRows ? row / 2 : row;
}

/// NV12. load() returns luma of eight columns, then interleaved U and V of four column pairs.
class SemiPlanarSource {
 public:
  explicit SemiPlanarSource(const YuvLayout& image) : image_(image) {}

  using Place = PlanarPlace;
  Place place(const RemapBlocks& blocks, size_t block) const {
    return planar_place<true>(image_, blocks, block);
  }

  template <int kTaps>
  void prefetch(const Place& place) const {
    prefetch_below<kTaps, 1>(image_.y.data + place.luma[0], image_.y.stride_bytes);
    prefetch_below<kTaps, 2, 1, 1>(image_.u.data + place.chroma[0][0], image_.u.stride_bytes);
  }

  template <int kGroup>
  __m256i samples(const Place& place, int pair, int row) const {
    static constexpr Shuffle kByChannel([](int, int i) {
      const int chroma = 8 + 4 * kGroup + 2 * (i % 4 / 2);
      const int from[] = {4 * kGroup + i % 4, chroma, chroma + 1, kNone};
      return from[i / 4];
    });
    return kByChannel(_mm256_set_m128i(load(place, pair + kPairs, row), load(place, pair, row)));
  }

 private:
  __m128i load(const Place& place, int pixel, int row) const {
    const uint8_t* const luma = image_.y.data + row * image_.y.stride_bytes;
    const uint8_t* const chroma = image_.u.data + chroma_row<true>(row) * image_.u.stride_bytes;
    return _mm_unpacklo_epi64(load_8(luma + place.luma[pixel]),
                              load_8(chroma + place.chroma[row % 2][pixel]));
  }

  const YuvLayout& image_;
};

/// 4:2:0 or 4:2:2 in three planes. load() returns luma of eight columns, then U and then V of four
/// column pairs.
template <bool kHalvedRows>
class PlanarSource {
 public:
  explicit PlanarSource(const YuvLayout& image) : image_(image) {}

  using Place = PlanarPlace;
  Place place(const RemapBlocks& blocks, size_t block) const {
    return planar_place<kHalvedRows>(image_, blocks, block);
  }

  template <int kTaps>
  void prefetch(const Place& place) const {
    constexpr int kRowShift = kHalvedRows ? 1 : 0;
    prefetch_below<kTaps, 1>(image_.y.data + place.luma[0], image_.y.stride_bytes);
    for (const ImagePlane& plane : {image_.u, image_.v}) {
      prefetch_below<kTaps, 1, kRowShift, 1>(plane.data + place.chroma[0][0], plane.stride_bytes);
    }
  }

  template <int kGroup>
  __m256i samples(const Place& place, int pair, int row) const {
    static constexpr Shuffle kByChannel([](int, int i) {
      const int chroma = 8 + 2 * kGroup + i % 4 / 2;
      const int from[] = {4 * kGroup + i % 4, chroma, chroma + 4, kNone};
      return from[i / 4];
    });
    return kByChannel(_mm256_set_m128i(load(place, pair + kPairs, row), load(place, pair, row)));
  }

 private:
  __m128i load(const Place& place, int pixel, int row) const {
    const uint8_t* const luma = image_.y.data + row * image_.y.stride_bytes;
    const std::ptrdiff_t chroma =
        place.chroma[row % 2][pixel] + chroma_row<kHalvedRows>(row) * image_.u.stride_bytes;
    return _mm_unpacklo_epi64(
        load_8(luma + place.luma[pixel]),
        _mm_unpacklo_epi32(load_4(image_.u.data + chroma), load_4(image_.v.data + chroma)));
  }

  const YuvLayout& image_;
};

/// Converts the means of eight pixels to RGB, with the same bits as the plain code.
class ToRgb {
 public:
  explicit ToRgb(const RgbFromYuv& colour)
      : colour_(colour),
        start_(colour.luma * ((128 << RgbFromYuv::kSampleBits) - colour.black) +
               (1 << (kBits - 1))) {}

  /// The arguments are means minus 128 with RgbFromYuv::kSampleBits fractional bits, in the low
  /// words.
  __m256i operator()(__m256i y, __m256i u, __m256i v) const {
    const __m256i luma = _mm256_add_epi32(product(y, colour_.luma), _mm256_set1_epi32(start_));
    const __m256i green =
        _mm256_add_epi32(product(u, colour_.green_u), product(v, colour_.green_v));
    return _mm256_xor_si256(
        bytes(_mm256_add_epi32(luma, product(v, colour_.red_v)), _mm256_sub_epi32(luma, green),
              _mm256_add_epi32(luma, product(u, colour_.blue_u))),
        _mm256_set1_epi8(-128));
  }

 private:
  static constexpr int kBits = RgbFromYuv::kSampleBits + RgbFromYuv::kCoefficientBits;

  static __m256i product(__m256i samples, int32_t coefficient) {
    return _mm256_madd_epi16(samples, _mm256_set1_epi32(coefficient));
  }
  static __m256i bytes(__m256i red, __m256i green, __m256i blue) {
    const __m256i red_green =
        _mm256_packs_epi32(_mm256_srai_epi32(red, kBits), _mm256_srai_epi32(green, kBits));
    const __m256i whole_blue = _mm256_srai_epi32(blue, kBits);
    return _mm256_packus_epi16(red_green, _mm256_packs_epi32(whole_blue, whole_blue));
  }

  RgbFromYuv colour_;
  int32_t start_;
};

template <int kTaps, int kParts, typename Source>
void remap_blocks(const YuvLayout& image, const RemapBlocks& blocks, int8_t* planes) {
  const Source source(image);
  const ToRgb to_rgb(rgb_from_yuv(image.encoding));
  for (size_t block = 0; block < blocks.index.size(); ++block) {
    __m256i means[kPairs] = {};
    for_each_part<kParts>(
        block, [&](size_t part) __attribute__((always_inline)) {
          const typename Source::Place place = source.place(blocks, part);
          source.template prefetch<kTaps>(place);
          for (int pair = 0; pair < kPairs; ++pair) {
            means[pair] = box_sums<kTaps>(source, place, blocks, part, pair, means[pair]);
          }
        });
    for (__m256i& mean : means) {
      mean = _mm256_srai_epi32(mean, 2 * RemapTable::kWeightBits - RgbFromYuv::kSampleBits);
    }
    const SumsByKind yuv(means);
    store_block(to_rgb(yuv.kinds[0], yuv.kinds[1], yuv.kinds[2]),
                planes + kPixels * blocks.index[block]);
  }
}

struct Readers {
  using Yuyv = PackedSource<0>;
  using Uyvy = PackedSource<1>;
  using Nv12 = SemiPlanarSource;
  using I420 = PlanarSource<true>;
  using I422 = PlanarSource<false>;
};

}  // namespace

BlockKernel<YuvLayout>* yuv_block_kernel(const YuvLayout& layout, int taps) {
  return kernel_of_layout<Readers>(layout, [taps]<typename Reader>() {
    return kernel_of_taps(taps, [](auto shape) -> BlockKernel<YuvLayout>* {
      return remap_blocks<shape.taps, shape.parts, Reader>;
    });
  });
}

}  // namespace bevloc
#endif
