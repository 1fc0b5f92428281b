#include "pipeline/localization/view_monitor.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include "common/target_clones.h"

namespace bevloc {
namespace {

// Levels are 0 to 255.
/// Simulated images at night have a mean of at least 30 and a contrast of at least 1.4.
constexpr double kDarkMean = 10.0;
constexpr double kDarkContrast = 3.0;
constexpr int kWhiteLevel = 225;
/// Simulated images by day are white in at most 17 % of their blocks.
constexpr double kBlindedShare = 0.40;

/// A tile is covered if its movement and its contrast are below these shares of the typical ones.
constexpr float kStillShare = 0.20F;
constexpr float kBlurredShare = 0.35F;
/// Rows in which the scene itself moves less, in levels, are not judged.
constexpr float kLeastMovement = 1.0F;
/// Tiles that make a camera dirty; with at most kCleanTiles it is clean again.
constexpr int kDirtyTiles = 6;
constexpr int kCleanTiles = 2;
/// Tiles at the lower edge, per column, that the own vehicle may cover.
constexpr int kOwnVehicleRows = 2;

constexpr int kLevelOffset = 128;  ///< the network input is the level minus this

constexpr int kBlockSide = 4;
constexpr int kBlocksAcross = kNetworkWidthPx / kBlockSide;

/// Sums the pixels of one row of blocks.
BEVLOC_TARGET_CLONES void sum_block_row(const int8_t* first, int16_t* sums) {
  std::array<int16_t, kNetworkWidthPx> columns{};
  for (int row = 0; row < kBlockSide; ++row) {
    for (int i = 0; i < kNetworkWidthPx; ++i) {
      columns[i] = static_cast<int16_t>(columns[i] + first[row * kNetworkWidthPx + i]);
    }
  }
  for (int i = 0; i < kBlocksAcross; ++i) {
    int sum = 0;
    for (int k = 0; k < kBlockSide; ++k) sum += columns[i * kBlockSide + k];
    sums[i] = static_cast<int16_t>(sum);
  }
}

constexpr int kTileSide = 4;  ///< blocks
constexpr int kTileBlocks = kTileSide * kTileSide;

/// The pattern of a tile: its blocks minus their mean, times the number of blocks.
std::array<int, kTileBlocks> pattern_of(const int16_t* first) {
  std::array<int, kTileBlocks> pattern{};
  int sum = 0;
  for (int i = 0; i < kTileBlocks; ++i) {
    const int block = first[i / kTileSide * kBlocksAcross + i % kTileSide];
    pattern[i] = block * kTileBlocks;
    sum += block;
  }
  for (int& block : pattern) block -= sum;
  return pattern;
}

}  // namespace

void ViewMonitor::sum_blocks(std::span<const int8_t> green, Blocks& blocks) {
  static_assert(kBlock == kBlockSide && kBlocksPerTile == kTileSide);
  for (int row = 0; row < kBlockRows; ++row) {
    sum_block_row(green.data() + static_cast<size_t>(row) * kBlock * kNetworkWidthPx,
                  blocks.data() + static_cast<size_t>(row) * kBlockCols);
  }
}

void ViewMonitor::set_shown(int camera, std::span<const uint8_t> shown) {
  constexpr int kTilePixels = kBlock * kBlocksPerTile;
  assert(shown.size() == static_cast<size_t>(kNetworkHeightPx) * kNetworkWidthPx);
  std::array<int, kRows * kCols> counts{};
  for (int v = 0; v < kNetworkHeightPx; ++v) {
    for (int u = 0; u < kNetworkWidthPx; ++u) {
      counts[v / kTilePixels * kCols + u / kTilePixels] += shown[v * kNetworkWidthPx + u];
    }
  }
  for (size_t tile = 0; tile < counts.size(); ++tile) {
    cameras_[camera].shown[tile] = 2 * counts[tile] >= kTilePixels * kTilePixels;
  }
}

ViewFault ViewMonitor::light_fault(const Blocks& blocks, const ShownTiles& shown) {
  constexpr int kPixels = kBlock * kBlock;
  constexpr int kWhiteSum = (kWhiteLevel - kLevelOffset) * kPixels;
  std::array<double, kRows * kCols> tiles{};
  // Such an image never changes, and would soon count as frozen. A new start of the camera does not
  // help.
  if (shown.none()) return ViewFault::kDark;
  const auto shown_tiles = static_cast<double>(shown.count());
  const double shown_blocks = shown_tiles * kBlocksPerTile * kBlocksPerTile;
  int white = 0;
  double sum = 0.0;
  for (int row = 0; row < kBlockRows; ++row) {
    for (int col = 0; col < kBlockCols; ++col) {
      const int tile = row / kBlocksPerTile * kCols + col / kBlocksPerTile;
      if (!shown[static_cast<size_t>(tile)]) continue;
      const int block = blocks[row * kBlockCols + col];
      white += block >= kWhiteSum ? 1 : 0;
      sum += block;
      tiles[tile] += block;
    }
  }
  if (white > kBlindedShare * shown_blocks) return ViewFault::kBlinded;
  const double mean = sum / (shown_blocks * kPixels) + kLevelOffset;
  if (mean >= kDarkMean) return ViewFault::kNone;
  double squares = 0.0;
  for (size_t tile = 0; tile < tiles.size(); ++tile) {
    if (!shown[tile]) continue;
    const double level = tiles[tile] / (kBlocksPerTile * kBlocksPerTile * kPixels) + kLevelOffset;
    squares += (level - mean) * (level - mean);
  }
  const double contrast = std::sqrt(squares / shown_tiles);
  return contrast < kDarkContrast ? ViewFault::kDark : ViewFault::kNone;
}

void ViewMonitor::note_light(ViewFault seen, Camera& camera) {
  if (seen != ViewFault::kNone) {
    camera.light = seen;
    camera.good_images = 0;
    camera.images = 0;
  } else if (camera.light != ViewFault::kNone && ++camera.good_images >= kRecovery) {
    camera.light = ViewFault::kNone;
  }
}

void ViewMonitor::note_movement(Camera& camera) {
  // The patterns are sums over blocks of pixels times the number of blocks; their mean is in
  // levels.
  constexpr float kToLevels = 1.0F / (kTileBlocks * kTileBlocks * kBlock * kBlock);
  const Blocks& newest = camera.blocks[camera.latest];
  const Blocks& before = camera.blocks[1 - camera.latest];
  camera.moved_images = std::min(camera.moved_images + 1, kImages);
  const float weight = 1.0F / static_cast<float>(camera.moved_images);
  for (int tile = 0; tile < kRows * kCols; ++tile) {
    const int first = tile / kCols * kBlocksPerTile * kBlockCols + tile % kCols * kBlocksPerTile;
    const auto now = pattern_of(newest.data() + first);
    const auto then = pattern_of(before.data() + first);
    int change = 0;
    int strength = 0;
    for (int i = 0; i < kTileBlocks; ++i) {
      change += std::abs(now[i] - then[i]);
      strength += std::abs(now[i]);
    }
    camera.movement[tile] +=
        weight * (kToLevels * static_cast<float>(change) - camera.movement[tile]);
    camera.contrast[tile] +=
        weight * (kToLevels * static_cast<float>(strength) - camera.contrast[tile]);
  }
}

void ViewMonitor::add(int camera, std::span<const int8_t> planes, bool driving) {
  constexpr size_t kPlane = static_cast<size_t>(kNetworkHeightPx) * kNetworkWidthPx;
  assert(planes.size() == 3 * kPlane);
  Camera& view = cameras_[camera];
  view.latest = 1 - view.latest;
  sum_blocks(planes.subspan(kPlane, kPlane), view.blocks[view.latest]);
  view.images = std::min(view.images + 1, 2);
  note_light(light_fault(view.blocks[view.latest], view.shown), view);
  if (driving && view.images == 2) note_movement(view);
}

float ViewMonitor::typical(int row, Tiles Camera::*values) {
  auto end = scratch_.begin();
  for (const Camera& camera : cameras_) {
    if (camera.moved_images < kImages || camera.light != ViewFault::kNone) continue;
    for (int tile = row * kCols; tile < (row + 1) * kCols; ++tile) {
      if (camera.shown[static_cast<size_t>(tile)]) *end++ = (camera.*values)[tile];
    }
  }
  if (end == scratch_.begin()) return 0.0F;
  const auto middle = scratch_.begin() + (end - scratch_.begin()) / 2;
  std::nth_element(scratch_.begin(), middle, end);
  return *middle;
}

int ViewMonitor::moving_rows() const {
  return static_cast<int>(std::count_if(typical_movement_.end() - kJudgedRows,
                                        typical_movement_.end(),
                                        [](float movement) { return movement >= kLeastMovement; }));
}

int ViewMonitor::covered_tiles(const Camera& camera) const {
  int covered = 0;
  for (int col = 0; col < kCols; ++col) {
    bool own_vehicle = true;
    for (int row = kRows - 1; row >= kRows - kJudgedRows; --row) {
      const int tile = row * kCols + col;
      const bool is_shown = camera.shown[static_cast<size_t>(tile)];
      const bool is_covered = is_shown && typical_movement_[row] >= kLeastMovement &&
                              camera.movement[tile] < kStillShare * typical_movement_[row] &&
                              camera.contrast[tile] < kBlurredShare * typical_contrast_[row];
      own_vehicle = own_vehicle && (is_covered || !is_shown) && row >= kRows - kOwnVehicleRows;
      covered += is_covered && !own_vehicle ? 1 : 0;
    }
  }
  return covered;
}

void ViewMonitor::judge() {
  for (int row = 0; row < kRows; ++row) {
    typical_movement_[row] = typical(row, &Camera::movement);
    typical_contrast_[row] = typical(row, &Camera::contrast);
  }
  const bool scene_moves = 2 * moving_rows() >= kJudgedRows;
  for (Camera& camera : cameras_) {
    if (camera.moved_images < kImages) continue;
    const int covered = covered_tiles(camera);
    const bool stays_dirty = camera.dirty && (covered > kCleanTiles || !scene_moves);
    camera.dirty = covered >= kDirtyTiles || stays_dirty;
  }
}

ViewFault ViewMonitor::fault(int camera) const {
  const Camera& view = cameras_[camera];
  if (view.light != ViewFault::kNone) return view.light;
  return view.dirty ? ViewFault::kDirty : ViewFault::kNone;
}

CameraMask ViewMonitor::with(ViewFault fault_kind) const {
  CameraMask mask;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    mask[camera] = fault(camera) == fault_kind;
  }
  return mask;
}

}  // namespace bevloc
