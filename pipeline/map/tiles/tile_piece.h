// Reads the pieces of one tile of a compact map, without memory of its own.
#pragma once

#include <string_view>

#include "pipeline/map/compact_codec.h"
#include "pipeline/map/tiles/tile_header.h"

namespace bevloc {

/// The part of an element in a tile. Its points follow in the decoder.
struct TilePiece {
  uint32_t element = 0;
  uint32_t first = 0;
  ElementClass element_class = ElementClass::kLaneDivider;
  Appearance appearance = Appearance::kUnknown;
  size_t count = 0;
};

/// Calls use(piece, decoder) for each piece of a tile; `use` reads the points, all of them, with
/// next_point(). Returns false if the bytes are no tile.
template <typename Use>
bool for_each_piece(std::string_view tile, int32_t column, int32_t row, uint32_t elements,
                    Use use) {
  CompactDecoder decoder(tile);
  uint64_t element = 0;
  while (!decoder.at_end()) {
    TilePiece piece;
    element += decoder.number_below(elements, "an element beyond the last");
    piece.element = static_cast<uint32_t>(element);
    piece.first = static_cast<uint32_t>(decoder.number_below(uint64_t{1} << 31U, "a point number"));
    const uint8_t look = decoder.byte();
    piece.element_class = static_cast<ElementClass>(look & 3U);
    piece.appearance = static_cast<Appearance>(look >> 2U);
    piece.count = decoder.count(2);
    if (element >= elements || (look & 3U) >= kElementClasses || (look >> 2U) >= kAppearances) {
      decoder.reject("a piece that no map can have");
    }
    if (decoder.error()) return false;
    decoder.start_from(column * kTileQuanta, row * kTileQuanta);
    use(piece, decoder);
    if (decoder.error()) return false;
  }
  return true;
}

inline Eigen::Vector2d next_point(CompactDecoder& decoder) {
  const auto x = static_cast<double>(decoder.coordinate(0));
  const auto y = static_cast<double>(decoder.coordinate(1));
  return {x * kMapQuantumM, y * kMapQuantumM};
}

}  // namespace bevloc
