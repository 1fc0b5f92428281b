// Detects cameras whose view is dark, blinded by light, or covered by dirt.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <span>

#include "common/cameras.h"
#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {

enum class ViewFault : uint8_t {
  kNone,
  kDark,     ///< the view is nearly black and without contrast: covered, or without light
  kBlinded,  ///< a large part is nearly white
  kDirty,    ///< parts of the view do not move while the vehicle drives
};

/// Judges the green plane of the network input of each camera. The limits were found on simulated
/// drives by day, at night and in rain (docs/tracker-and-health.md).
///
/// - Dark and blinded are judged by one image. Such an image must not be matched at all, so the
///   camera is unusable at once, and usable again after kRecovery good images in a row.
/// - Dirty is judged by kImages images of a driving vehicle. The image is divided into tiles. Dirt
///   on a lens is out of focus and stays in its place, so behind it the pattern inside a tile
///   hardly moves and has hardly any contrast, compared with the tiles of all cameras in the same
///   row. Only the pattern counts, because the brightness of dirt changes with the scene. Up to two
///   covered tiles at the lower edge of each column show the own vehicle, and the uppermost row
///   shows mostly sky. Neither counts. A dirty camera stays dirty while the scene hardly moves in
///   most rows, because such a scene hides the dirt.
///
/// Six cameras take about 40 us. Allocates nothing. One thread.
class ViewMonitor {
 public:
  static constexpr int kRecovery = 10;
  static constexpr int kImages = 100;

  /// `shown` is 1 for each pixel of a camera's network image that shows a part of its view, else 0.
  /// The other pixels are black, because they lie outside of the real image or on the own vehicle.
  /// Tiles that are mostly black are not judged. A camera without any other tile counts as dark.
  /// Without a call, all tiles are judged.
  void set_shown(int camera, std::span<const uint8_t> shown);

  /// Adds the network input of a new frame of `camera`. The frame counts for movement only while
  /// `driving`.
  void add(int camera, std::span<const int8_t> planes, bool driving);

  /// Compares the cameras. Call it once per frameset, after add().
  void judge();

  ViewFault fault(int camera) const;
  /// The cameras with this fault.
  CameraMask with(ViewFault fault) const;

 private:
  static constexpr int kBlock = 4;          ///< pixels of the side of a block
  static constexpr int kBlocksPerTile = 4;  ///< per side
  static constexpr int kRows = kNetworkHeightPx / (kBlock * kBlocksPerTile);
  static constexpr int kCols = kNetworkWidthPx / (kBlock * kBlocksPerTile);
  static constexpr int kJudgedRows = kRows - 1;  ///< all but the uppermost
  static constexpr int kBlockRows = kRows * kBlocksPerTile;
  static constexpr int kBlockCols = kCols * kBlocksPerTile;

  using Blocks = std::array<int16_t, kBlockRows * kBlockCols>;  ///< sums over a block's pixels
  using Tiles = std::array<float, kRows * kCols>;
  using ShownTiles = std::bitset<kRows * kCols>;

  struct Camera {
    ShownTiles shown = ShownTiles().set();
    std::array<Blocks, 2> blocks{};  ///< blocks of the latest two images, in turn
    int latest = 0;                  ///< index of the latest
    int images = 0;                  ///< number since the last fault of light, at most 2
    Tiles movement{};                ///< mean change of the pattern inside a tile
    Tiles contrast{};                ///< mean strength of that pattern
    int moved_images = 0;            ///< images that the two means contain, at most kImages
    ViewFault light = ViewFault::kNone;
    int good_images = 0;  ///< in a row since `light` was seen
    bool dirty = false;
  };

  static void sum_blocks(std::span<const int8_t> green, Blocks& blocks);
  static ViewFault light_fault(const Blocks& blocks, const ShownTiles& shown);
  static void note_light(ViewFault seen, Camera& camera);
  static void note_movement(Camera& camera);
  /// The median of a row over the cameras that have driven long enough, or 0 if there are none.
  float typical(int row, Tiles Camera::*values);
  /// The number of judged rows in which the scene moves enough to show dirt.
  int moving_rows() const;
  int covered_tiles(const Camera& camera) const;

  std::array<Camera, kCameraCount> cameras_;
  std::array<float, kRows> typical_movement_{};
  std::array<float, kRows> typical_contrast_{};
  std::array<float, static_cast<size_t>(kCameraCount) * kCols> scratch_{};
};

}  // namespace bevloc
