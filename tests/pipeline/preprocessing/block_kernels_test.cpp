// Compares the block kernels with the plain code.
#include "pipeline/preprocessing/block_kernels.h"

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/pipeline/preprocessing/guarded_bytes.h"

namespace bevloc {
namespace {

using Planes = std::vector<int8_t>;
using Random = std::mt19937;

constexpr size_t kPlanesSize = 3 * static_cast<size_t>(kNetworkPixels);
constexpr std::array kBayerFormats{PixelFormat::kBayerRggb, PixelFormat::kBayerGrbg,
                                   PixelFormat::kBayerGbrg, PixelFormat::kBayerBggr};

int below(Random& random, int end) {
  return static_cast<int>(random() % static_cast<unsigned>(end));
}

/// Fills in random weights. Sometimes one or two pixels have all the weight, as at image edges.
void fill_weights(Random& random, std::span<uint16_t> weights) {
  std::ranges::fill(weights, uint16_t{0});
  int remainder = RemapTable::kWeightSum;
  const int kind = below(random, 10);
  const int largest = kind == 0   ? remainder
                      : kind == 1 ? 255
                                  : 1 + remainder / (below(random, 4) + 1);
  while (remainder > 0) {
    const int weight = std::min(remainder, kind < 2 ? largest : below(random, largest) + 1);
    const int tap = below(random, static_cast<int>(weights.size()));
    weights[tap] = static_cast<uint16_t>(weights[tap] + weight);
    remainder -= weight;
  }
}

/// Each pixel has a box at a random position; some pixels have no weights.
RemapTable random_table(Random& random, int taps, int width, int height) {
  RemapTable table;
  table.taps = taps;
  const auto both = 2 * static_cast<size_t>(taps);
  table.weights.resize(both * kNetworkPixels);
  for (int i = 0; i < kNetworkPixels; ++i) {
    table.first_col.push_back(static_cast<uint16_t>(below(random, width - taps + 1)));
    table.first_row.push_back(static_cast<uint16_t>(below(random, height - taps + 1)));
    const bool is_outside = below(random, 20) == 0 || (i > 4000 && i < 5000);
    if (is_outside) continue;
    const std::span<uint16_t> weights = std::span(table.weights).subspan(both * i, both);
    fill_weights(random, weights.first(taps));
    fill_weights(random, weights.last(taps));
  }
  table.blocks = make_remap_blocks(table, width, height);
  return table;
}

/// Fills with random bytes, or only with 0 and 255 if `is_extreme`.
void fill(Random& random, std::span<uint8_t> bytes, bool is_extreme) {
  for (uint8_t& byte : bytes) {
    byte = static_cast<uint8_t>(is_extreme ? (random() & 4) / 4 * 255 : random());
  }
}

constexpr int kWidth = 48;
constexpr int kHeight = 30;

class BlockKernels : public testing::TestWithParam<std::tuple<int, bool, bool>> {
 protected:
  BlockKernels() : table_(random_table(random_, taps(), kWidth, kHeight)) {}

  static int taps() { return std::get<0>(GetParam()); }

  /// A plane with padding between its rows.
  ImagePlane plane(int row_bytes, int rows) {
    const std::ptrdiff_t stride = row_bytes + 6;
    const size_t size = static_cast<size_t>(stride) * (rows - 1) + row_bytes;
    memory_.push_back(std::make_unique<test::GuardedBytes>(size, std::get<2>(GetParam())));
    fill(random_, memory_.back()->bytes(), std::get<1>(GetParam()));
    return {memory_.back()->bytes().data(), stride};
  }

  template <typename Remap, typename Plain, typename Image>
  void expect_same(Remap& remap, Plain& plain, const Image& image) {
    Planes wanted(kPlanesSize, 1);
    Planes planes(kPlanesSize, 2);
    plain(image, table_, kAllNetworkPixels, wanted.data());
    remap(image, table_, planes.data());
    const auto difference = std::ranges::mismatch(planes, wanted).in1;
    EXPECT_EQ(difference - planes.begin(), kPlanesSize) << "index of the first different value";
  }

  Random random_{4711};
  RemapTable table_;
  std::vector<std::unique_ptr<test::GuardedBytes>> memory_;
};

TEST_P(BlockKernels, OfRgbEqualThePlainCode) {
  const auto [data, stride] = plane(3 * kWidth, kHeight);
  expect_same(remap_rgb, remap_rgb_plain, RgbView{data, kWidth, kHeight, stride});
}

TEST_P(BlockKernels, OfPackedYuvEqualThePlainCode) {
  for (const int luma : {0, 1}) {
    const auto [data, stride] = plane(2 * kWidth, kHeight);
    expect_same(remap_yuv, remap_yuv_plain,
                YuvLayout{.y = {data + luma, stride},
                          .u = {data + 1 - luma, stride},
                          .v = {data + 3 - luma, stride},
                          .y_step = 2,
                          .chroma_step = 4,
                          .chroma_shift_x = 1,
                          .encoding = {YuvMatrix::kBt601, luma == 1}});
  }
}

TEST_P(BlockKernels, OfNv12EqualThePlainCode) {
  for (const bool is_full : {false, true}) {
    const ImagePlane luma = plane(kWidth, kHeight);
    const auto [data, stride] = plane(kWidth, kHeight / 2);
    expect_same(remap_yuv, remap_yuv_plain,
                YuvLayout{.y = luma,
                          .u = {data, stride},
                          .v = {data + 1, stride},
                          .chroma_step = 2,
                          .chroma_shift_x = 1,
                          .chroma_shift_y = 1,
                          .encoding = {YuvMatrix::kBt709, is_full}});
  }
}

TEST_P(BlockKernels, OfPlanarYuvEqualThePlainCode) {
  for (const int shift_x : {0, 1}) {
    for (const int shift_y : {0, 1}) {
      const int cols = kWidth >> shift_x;
      const int rows = kHeight >> shift_y;
      expect_same(remap_yuv, remap_yuv_plain,
                  YuvLayout{.y = plane(kWidth, kHeight),
                            .u = plane(cols, rows),
                            .v = plane(cols, rows),
                            .chroma_shift_x = shift_x,
                            .chroma_shift_y = shift_y,
                            .encoding = {YuvMatrix::kBt601, true}});
    }
  }
}

TEST_P(BlockKernels, OfBayerEqualThePlainCode) {
  for (const PixelFormat format : kBayerFormats) {
    SCOPED_TRACE(to_string(format));
    ImageView image;
    image.format = format;
    image.width = kWidth;
    image.height = kHeight;
    image.planes[0] = plane(kWidth, kHeight);
    expect_same(remap_bayer, remap_bayer_plain, image);
  }
}

TEST_P(BlockKernels, ExistForCommonBoxes) {
  const bool has_kernels = can_run_block_kernels() && taps() <= RemapBlocks::kMaxTaps;
  YuvLayout halved;
  halved.chroma_shift_x = 1;
  EXPECT_EQ(rgb_kernel_for(taps()) != nullptr, has_kernels);
  EXPECT_EQ(yuv_kernel_for(halved, taps()) != nullptr, has_kernels);
  EXPECT_EQ(bayer_kernel_for(taps()) != nullptr, has_kernels);
}

/// Each pixel is in one block or in a range for the plain code, or in both.
TEST_P(BlockKernels, CoverEveryPixel) {
  const RemapBlocks& blocks = table_.blocks;
  std::vector<bool> is_written(kNetworkPixels, false);
  for (const uint16_t index : blocks.index) {
    const auto first = is_written.begin() + RemapBlocks::kPixels * index;
    EXPECT_FALSE(*first) << "repeated block";
    std::fill_n(first, RemapBlocks::kPixels, true);
  }
  int end = 0;
  for (const PixelRange range : blocks.others) {
    EXPECT_LT(range.begin, range.end);
    EXPECT_GE(range.begin, end) << "not in reading order";
    end = range.end;
    std::fill(is_written.begin() + range.begin, is_written.begin() + range.end, true);
  }
  EXPECT_EQ(std::ranges::count(is_written, false), 0);
  EXPECT_EQ(blocks.index.empty(), taps() > RemapBlocks::kMaxTaps);
}

std::string name_of(const testing::TestParamInfo<BlockKernels::ParamType>& test) {
  const auto& [taps, is_extreme, ends_in_front] = test.param;
  return std::to_string(taps) + "_taps_" + (is_extreme ? "extreme" : "any") + "_" +
         (ends_in_front ? "first" : "last") + "_in_memory";
}

INSTANTIATE_TEST_SUITE_P(Boxes, BlockKernels,
                         testing::Combine(testing::Range(2, 15), testing::Bool(), testing::Bool()),
                         name_of);

}  // namespace
}  // namespace bevloc
