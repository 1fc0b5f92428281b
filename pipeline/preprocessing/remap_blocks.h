// A remap table in the memory layout of the vectorised kernels.
#pragma once

#include <cstdint>
#include <vector>

namespace bevloc {

struct RemapTable;

/// Network pixels from `begin` to before `end`, in reading order.
struct PixelRange {
  int begin;
  int end;
};

/// A block is eight adjacent pixels of a row. A kernel computes a pixel if its box respects the
/// margins below, so that samples of every format may be read in whole words, and if no weight
/// exceeds 254. The plain code computes all other pixels, including those that see no camera pixel.
///
/// A box of more than kMaxPartTaps taps is divided into two by two parts, which may overlap; their
/// sums add up to that of the box.
struct RemapBlocks {
  static constexpr int kPixels = 8;
  static constexpr int kMaxTaps = 13;
  static constexpr int kMaxPartTaps = 7;

  /// Number of outermost columns at the left edge of the image, and of outermost columns or rows at
  /// the other edges, that the box of such a pixel must leave out.
  static constexpr int kLeftMargin_px = 2;
  static constexpr int kMargin_px = 1;
  /// A kernel may read this many pixels of a row from the first column of a box. If that passes the
  /// end of the row, kRowsBelow further rows must exist.
  static constexpr int kReach_px = 16;
  static constexpr int kRowsBelow = 2;

  /// How a box along one axis is divided.
  struct Division {
    int parts = 1;   ///< 1 or 2
    int taps = 0;    ///< taps of each part
    int offset = 0;  ///< start of the second part; even, so that chroma and colours agree
  };
  static constexpr Division division(int taps) {
    if (taps <= kMaxPartTaps) return {1, taps, 0};
    const int offset = taps < 11 ? 4 : 6;
    return {2, taps - offset < offset ? offset : taps - offset, offset};
  }

  /// Number of weights of a pixel along each axis of a part, padded with zeros.
  static constexpr int slots(int part_taps) { return part_taps <= 3 ? 4 : 8; }

  std::vector<uint16_t> index;  ///< per block: its first pixel is kPixels * index
  // The next three contain the parts of a block one after the other, row by row.
  std::vector<uint16_t> first_col;  ///< per pixel of a part, rounded down to an even number
  std::vector<uint16_t> first_row;
  /// Column weights, then row weights, per pixel. The pixels of a part come in the order 0, 4, 1,
  /// 5, 2, 6, 3, 7. The weights of pixels that the plain code computes are 0.
  std::vector<uint8_t> weights;
  std::vector<PixelRange> others;  ///< pixels for the plain code
};

/// If the table has more than kMaxTaps taps, all pixels are in `others`.
RemapBlocks make_remap_blocks(const RemapTable& table, int width_px, int height_px);

}  // namespace bevloc
