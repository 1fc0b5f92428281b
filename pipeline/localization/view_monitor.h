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
  kDark,     ///< nearly black and without contrast: covered, or without light
  kBlinded,  ///< a large part is nearly white
  kDirty,    ///< parts of the view do not move while the vehicle drives
};

/// Judges the network input of all cameras, in its green plane. The limits were found on simulated
/// drives by day, at night and in rain (docs/tracker-and-health.md).
///
/// - Dark and blinded: by one image. Such an image must not be matched at all, so the camera is
///   unusable at once, and usable again after kRecovery good images in a row.
/// - Dirty: by kImages images of a driving vehicle. The image is divided into tiles. Dirt on a lens
///   is out of focus and stays in its place, so behind it the pattern inside a tile hardly moves
///   and has hardly any contrast, compared with the tiles of all cameras in the same row. What
///   counts is the pattern: the brightness of dirt changes with the scene. Tiles that reach up from
///   the lower edge show the own vehicle, and the uppermost row shows mostly sky; neither counts.
///
/// Six cameras take about 40 us. Allocates nothing. Not thread safe.
class ViewMonitor {
 public:
  static constexpr int kRecovery = 10;
  static constexpr int kImages = 100;

  /// Says which pixels of a camera's network image show anything of its view: 1, else 0. The others
  /// are black: outside of the real image, or on the own vehicle. Tiles that are mostly black are
  /// not judged. Without a call, all are.
  void set_shown(int camera, std::span<const uint8_t> shown);

  /// Adds the network input of a new frame of `camera`. Counts as movement only while `driving`.
  void add(int camera, std::span<const int8_t> planes, bool driving);

  /// Compares the cameras. To be called once per frameset, after add().
  void judge();

  ViewFault fault(int camera) const;
  /// The cameras with this fault.
  CameraMask with(ViewFault fault) const;

 private:
  static constexpr int kBlock = 4;          ///< pixels of the side of a block
  static constexpr int kBlocksPerTile = 4;  ///< per side
  static constexpr int kRows = kNetworkHeightPx / (kBlock * kBlocksPerTile);
  static constexpr int kCols = kNetworkWidthPx / (kBlock * kBlocksPerTile);
  static constexpr int kBlockRows = kRows * kBlocksPerTile;
  static constexpr int kBlockCols = kCols * kBlocksPerTile;

  using Blocks = std::array<int16_t, kBlockRows * kBlockCols>;  ///< sums over a block's pixels
  using Tiles = std::array<float, kRows * kCols>;
  using ShownTiles = std::bitset<kRows * kCols>;

  struct Camera {
    ShownTiles shown = ShownTiles().set();
    std::array<Blocks, 2> blocks{};  ///< of the latest two images, in turn
    int latest = 0;                  ///< index of the latest
    int images = 0;                  ///< since the last fault of light, at most 2
    Tiles movement{};                ///< mean change of the pattern inside a tile
    Tiles contrast{};                ///< mean strength of that pattern
    int moved_images = 0;            ///< that the two means contain, at most kImages
    ViewFault light = ViewFault::kNone;
    int good_images = 0;  ///< in a row since `light` was seen
    bool dirty = false;
  };

  static void sum_blocks(std::span<const int8_t> green, Blocks& blocks);
  static ViewFault light_fault(const Blocks& blocks, const ShownTiles& shown);
  static void note_light(ViewFault seen, Camera& camera);
  static void note_movement(Camera& camera);
  /// The median of a row over the cameras that have driven long enough; 0 without any.
  float typical(int row, Tiles Camera::*values);
  int covered_tiles(const Camera& camera) const;

  std::array<Camera, kCameraCount> cameras_;
  std::array<float, kRows> typical_movement_{};
  std::array<float, kRows> typical_contrast_{};
  std::array<float, static_cast<size_t>(kCameraCount) * kCols> scratch_{};
};

}  // namespace bevloc
