// A compact map file that stays on disk: only the tiles around the vehicle are read.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "common/mapped_file.h"
#include "common/result.h"
#include "pipeline/map/tiles/tile_codec.h"

namespace bevloc {

/// Maps a file of version 2 into memory. Opening reads the header and the directory only. The file
/// must not change while it is open: replace it by renaming another one to its name. Thread-safe.
class TiledMap {
 public:
  /// A segment of an element, from point `first` to the next; the last one of a ring closes it.
  struct Segment {
    uint32_t element;
    uint32_t first;
    ElementClass element_class;
    Appearance appearance;
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };

  /// Fails, with file and byte, as TileDirectory::open() does, and on files that cannot be mapped.
  static Result<std::unique_ptr<TiledMap>> open(const std::filesystem::path& path);
  TiledMap(const TiledMap&) = delete;
  TiledMap& operator=(const TiledMap&) = delete;

  const TiledMapFacts& facts() const { return directory_.facts(); }

  /// Replaces `found` with the segments whose bounding boxes intersect the given one, sorted by
  /// element, then by point. Segments that do not touch the box themselves may be missing. The
  /// time depends on the number of segments in the tiles under the box. Allocates only if `found`
  /// must grow. A tile is compared with its checksum when it is first touched; a damaged one counts
  /// as empty.
  void query(const Eigen::Vector2d& min_corner, const Eigen::Vector2d& max_corner,
             std::vector<Segment>& found) const;

  /// The number of damaged tiles that were touched so far.
  size_t damaged_tiles() const { return damaged_tiles_.load(std::memory_order_relaxed); }

 private:
  enum class TileState : uint8_t { kUnknown, kGood, kDamaged };

  TiledMap(MappedFile file, const TileDirectory& directory);
  bool is_good(size_t index, const TileDirectory::Entry& entry) const;
  void add_tile(size_t index, const Eigen::Vector2d& min_corner, const Eigen::Vector2d& max_corner,
                std::vector<Segment>& found) const;

  MappedFile file_;
  TileDirectory directory_;  ///< borrows from file_
  std::unique_ptr<std::atomic<TileState>[]> states_;
  mutable std::atomic<size_t> damaged_tiles_{0};
};

}  // namespace bevloc
