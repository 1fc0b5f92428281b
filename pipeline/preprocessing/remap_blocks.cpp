#include "pipeline/preprocessing/remap_blocks.h"

#include <algorithm>
#include <array>
#include <span>

#include "pipeline/preprocessing/remap_table.h"

namespace bevloc {
namespace {

constexpr int kPixels = RemapBlocks::kPixels;
constexpr uint16_t kMaxWeight = 254;

class BlockMaker {
 public:
  BlockMaker(const RemapTable& table, int width_px, int height_px)
      : table_(table),
        width_px_(width_px),
        height_px_(height_px),
        slots_(RemapBlocks::slots(table.taps)) {}

  RemapBlocks make() && {
    for (int first = 0; first < kNetworkPixels; first += kPixels) add_block(first);
    return std::move(blocks_);
  }

 private:
  std::span<const uint16_t> weights_of(int pixel) const {
    const auto both = 2 * static_cast<size_t>(table_.taps);
    return std::span(table_.weights).subspan(both * pixel, both);
  }

  bool fits(int pixel) const {
    const std::span<const uint16_t> weights = weights_of(pixel);
    if (std::ranges::all_of(weights, [](uint16_t weight) { return weight == 0; })) return false;
    if (*std::ranges::max_element(weights) > kMaxWeight) return false;
    const int col = table_.first_col[pixel];
    const int row = table_.first_row[pixel];
    const int last_col = col + table_.taps - 1;
    const int last_row = row + table_.taps - 1;
    return col >= RemapBlocks::kLeftMargin_px && last_col < width_px_ - RemapBlocks::kMargin_px &&
           row >= RemapBlocks::kMargin_px && last_row < height_px_ - RemapBlocks::kMargin_px &&
           (col + RemapBlocks::kReach_px <= width_px_ ||
            last_row + RemapBlocks::kRowsBelow < height_px_);
  }

  void add_block(int first) {
    std::array<bool, kPixels> is_in{};
    for (int i = 0; i < kPixels; ++i) {
      is_in[i] = fits(first + i);
      if (!is_in[i]) add_other(first + i);
    }
    const auto any = std::ranges::find(is_in, true);
    if (any == is_in.end()) return;
    const int safe = first + static_cast<int>(any - is_in.begin());
    blocks_.index.push_back(static_cast<uint16_t>(first / kPixels));
    for (int i = 0; i < kPixels; ++i) {
      const int pixel = is_in[i] ? first + i : safe;
      blocks_.first_col.push_back(static_cast<uint16_t>(table_.first_col[pixel] / 2 * 2));
      blocks_.first_row.push_back(table_.first_row[pixel]);
    }
    for (int i = 0; i < kPixels / 2; ++i) {
      add_weights(first + i, is_in[i]);
      add_weights(first + i + kPixels / 2, is_in[i + kPixels / 2]);
    }
  }

  void add_weights(int pixel, bool is_in) {
    std::vector<uint8_t>& bytes = blocks_.weights;
    const size_t cols = bytes.size() + table_.first_col[pixel] % 2;
    const size_t rows = bytes.size() + slots_;
    bytes.resize(rows + slots_);
    if (!is_in) return;
    const std::span<const uint16_t> weights = weights_of(pixel);
    for (int i = 0; i < table_.taps; ++i) {
      bytes[cols + i] = static_cast<uint8_t>(weights[i]);
      bytes[rows + i] = static_cast<uint8_t>(weights[table_.taps + i]);
    }
  }

  void add_other(int pixel) {
    std::vector<PixelRange>& others = blocks_.others;
    if (others.empty() || others.back().end != pixel) others.push_back({pixel, pixel});
    others.back().end = pixel + 1;
  }

  const RemapTable& table_;
  int width_px_;
  int height_px_;
  size_t slots_;
  RemapBlocks blocks_;
};

}  // namespace

RemapBlocks make_remap_blocks(const RemapTable& table, int width_px, int height_px) {
  if (table.taps > RemapBlocks::kMaxTaps) {
    RemapBlocks none;
    none.others.push_back(kAllNetworkPixels);
    return none;
  }
  return BlockMaker(table, width_px, height_px).make();
}

}  // namespace bevloc
