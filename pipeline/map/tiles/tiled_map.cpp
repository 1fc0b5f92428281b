#include "pipeline/map/tiles/tiled_map.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "common/crc32.h"
#include "pipeline/map/tiles/tile_piece.h"

namespace bevloc {
namespace {

bool boxes_meet(const TiledMap::Segment& segment, const Eigen::Vector2d& low,
                const Eigen::Vector2d& high) {
  return (segment.from.cwiseMin(segment.to).array() <= high.array()).all() &&
         (segment.from.cwiseMax(segment.to).array() >= low.array()).all();
}

}  // namespace

Result<std::unique_ptr<TiledMap>> TiledMap::open(const std::filesystem::path& path) {
  auto file = MappedFile::open(path, "a compact map");
  if (!file) return tl::unexpected(file.error());
  const auto directory = TileDirectory::open(file->bytes(), path.string());
  if (!directory) return tl::unexpected(directory.error());
  return std::unique_ptr<TiledMap>(new TiledMap(std::move(*file), *directory));
}

TiledMap::TiledMap(MappedFile file, const TileDirectory& directory)
    : file_(std::move(file)),
      directory_(directory),
      states_(std::make_unique<std::atomic<TileState>[]>(directory.size())) {}

bool TiledMap::is_good(size_t index, const TileDirectory::Entry& entry) const {
  const TileState known = states_[index].load(std::memory_order_relaxed);
  if (known != TileState::kUnknown) return known == TileState::kGood;
  const std::string_view tile = directory_.tile(entry);
  const bool good = crc32(tile) == entry.crc &&
                    for_each_piece(tile, entry.column, entry.row, facts().elements,
                                   [](const TilePiece& piece, CompactDecoder& decoder) {
                                     for (size_t i = 0; i < piece.count; ++i) next_point(decoder);
                                   });
  const TileState found = good ? TileState::kGood : TileState::kDamaged;
  if (states_[index].exchange(found, std::memory_order_relaxed) == TileState::kUnknown && !good) {
    damaged_tiles_.fetch_add(1, std::memory_order_relaxed);
  }
  return good;
}

void TiledMap::query(const Eigen::Vector2d& min_corner, const Eigen::Vector2d& max_corner,
                     std::vector<Segment>& found) const {
  found.clear();
  const int32_t last_row = tile_of(max_corner.y());
  const int32_t last_column = tile_of(max_corner.x());
  const double tiles = (static_cast<double>(last_row) - tile_of(min_corner.y()) + 1.0) *
                       (static_cast<double>(last_column) - tile_of(min_corner.x()) + 1.0);
  const bool covers_all = tiles > static_cast<double>(directory_.size());
  for (size_t i = 0; covers_all && i < directory_.size(); ++i) {
    add_tile(i, min_corner, max_corner, found);
  }
  for (int32_t row = tile_of(min_corner.y()); row <= last_row && !covers_all; ++row) {
    for (int32_t column = tile_of(min_corner.x()); column <= last_column; ++column) {
      if (const auto index = directory_.find(column, row)) {
        add_tile(*index, min_corner, max_corner, found);
      }
    }
  }
  const auto place = [](const Segment& segment) {
    return std::tuple(segment.element, segment.first);
  };
  std::ranges::sort(found, {}, place);
  const auto is_same = [&place](const Segment& a, const Segment& b) {
    return place(a) == place(b);
  };
  found.erase(std::unique(found.begin(), found.end(), is_same), found.end());
}

void TiledMap::add_tile(size_t index, const Eigen::Vector2d& min_corner,
                        const Eigen::Vector2d& max_corner, std::vector<Segment>& found) const {
  const TileDirectory::Entry entry = directory_.entry(index);
  if (!is_good(index, entry)) return;
  const auto add = [&](const Segment& segment) {
    if (boxes_meet(segment, min_corner, max_corner)) found.push_back(segment);
  };
  for_each_piece(directory_.tile(entry), entry.column, entry.row, facts().elements,
                 [&](const TilePiece& piece, CompactDecoder& decoder) {
                   if (piece.count == 0) return;
                   const Eigen::Vector2d start = next_point(decoder);
                   Segment segment{piece.element,    piece.first, piece.element_class,
                                   piece.appearance, start,       start};
                   for (size_t i = 1; i < piece.count; ++i) {
                     segment.from = std::exchange(segment.to, next_point(decoder));
                     add(segment);
                     ++segment.first;
                   }
                   if (!is_ring(piece.element_class) || piece.count <= 2) return;
                   segment.from = segment.to;
                   segment.to = start;
                   add(segment);
                 });
}

}  // namespace bevloc
