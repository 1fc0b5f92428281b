// A remap table laid out for kernels that take eight network pixels at once.
#pragma once

#include <cstdint>
#include <vector>

namespace bevloc {

struct RemapTable;

/// Network pixels in reading order.
struct PixelRange {
  int begin;
  int end;
};

/// Eight neighbours of a row make a block. A pixel is in one if its box, wherever a format has its
/// samples, may be read in whole words: the margins below are about that. Weights of 255 and more
/// do not fit. All other pixels, those that see nothing among them, are left to the plain code.
struct RemapBlocks {
  static constexpr int kPixels = 8;
  static constexpr int kMaxTaps = 7;

  /// Pixels at the frame's left edge, at the others, that no box may touch.
  static constexpr int kLeftMargin_px = 2;
  static constexpr int kMargin_px = 1;
  /// From its first column on, what is read of a row may be as long: beyond the row's end it needs
  /// kRowsBelow more.
  static constexpr int kReach_px = 16;
  static constexpr int kRowsBelow = 2;

  /// Weights of a pixel along each axis, the last ones 0.
  static constexpr int slots(int taps) { return taps <= 3 ? 4 : 8; }

  std::vector<uint16_t> index;      ///< of each block: kPixels * index is its first pixel
  std::vector<uint16_t> first_col;  ///< of each pixel in a block, rounded down to an even one
  std::vector<uint16_t> first_row;
  /// Of pixel 0 of a block the columns' and the rows', of pixel 4 likewise; of 1 and 5, and so on.
  /// Those of a pixel that is left to the plain code are 0.
  std::vector<uint8_t> weights;
  std::vector<PixelRange> others;  ///< not in a block, or with weights of 0 there
};

/// More than kMaxTaps: all are others.
RemapBlocks make_remap_blocks(const RemapTable& table, int width_px, int height_px);

}  // namespace bevloc
