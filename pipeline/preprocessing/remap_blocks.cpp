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
        division_(RemapBlocks::division(table.taps)),
        extent_((division_.parts - 1) * division_.offset + division_.taps),
        slots_(RemapBlocks::slots(division_.taps)) {}

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
    const int last_col = col + extent_ - 1;
    const int last_row = row + extent_ - 1;
    const int last_part_col = col + (division_.parts - 1) * division_.offset;
    return col >= RemapBlocks::kLeftMargin_px && last_col < width_px_ - RemapBlocks::kMargin_px &&
           row >= RemapBlocks::kMargin_px && last_row < height_px_ - RemapBlocks::kMargin_px &&
           (last_part_col + RemapBlocks::kReach_px <= width_px_ ||
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
    for (int part_row = 0; part_row < division_.parts; ++part_row) {
      for (int part_col = 0; part_col < division_.parts; ++part_col) {
        add_part(first, is_in, safe, part_row, part_col);
      }
    }
  }

  void add_part(int first, const std::array<bool, kPixels>& is_in, int safe, int part_row,
                int part_col) {
    for (int i = 0; i < kPixels; ++i) {
      const int pixel = is_in[i] ? first + i : safe;
      const int col = table_.first_col[pixel] + part_col * division_.offset;
      const int row = table_.first_row[pixel] + part_row * division_.offset;
      blocks_.first_col.push_back(static_cast<uint16_t>(col / 2 * 2));
      blocks_.first_row.push_back(static_cast<uint16_t>(row));
    }
    for (int i = 0; i < kPixels / 2; ++i) {
      for (const int in_block : {i, i + kPixels / 2}) {
        add_weights(first + in_block, is_in[in_block], part_row, part_col);
      }
    }
  }

  void add_weights(int pixel, bool is_in, int part_row, int part_col) {
    std::vector<uint8_t>& bytes = blocks_.weights;
    const size_t cols = bytes.size() + table_.first_col[pixel] % 2;
    const size_t rows = bytes.size() + slots_;
    bytes.resize(rows + slots_);
    if (!is_in) return;
    const std::span<const uint16_t> weights = weights_of(pixel);
    const auto taps = static_cast<size_t>(table_.taps);
    for (int i = 0; i < division_.taps; ++i) {
      bytes[cols + i] = part_weight(weights.first(taps), part_col, i);
      bytes[rows + i] = part_weight(weights.last(taps), part_row, i);
    }
  }

  /// A sample in both parts counts in the first one.
  uint8_t part_weight(std::span<const uint16_t> weights, int part, int i) const {
    const int tap = part * division_.offset + i;
    if (tap >= table_.taps || (part > 0 && tap < division_.taps)) return 0;
    return static_cast<uint8_t>(weights[static_cast<size_t>(tap)]);
  }

  void add_other(int pixel) {
    std::vector<PixelRange>& others = blocks_.others;
    if (others.empty() || others.back().end != pixel) others.push_back({pixel, pixel});
    others.back().end = pixel + 1;
  }

  const RemapTable& table_;
  int width_px_;
  int height_px_;
  RemapBlocks::Division division_;
  int extent_;  ///< taps of all parts together along each axis
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
