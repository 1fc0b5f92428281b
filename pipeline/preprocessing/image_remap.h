// From a camera's frame to the network's input: undistort, crop, resize and quantise in one pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/image.h"
#include "common/result.h"
#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {

/// Number of values of one network input image: planes [3, kNetworkHeightPx, kNetworkWidthPx].
inline constexpr size_t kNetworkImageSize =
    3 * static_cast<size_t>(kNetworkWidthPx) * kNetworkHeightPx;

/// Network input of a black pixel: a camera that is missing is black throughout.
inline constexpr int8_t kNetworkBlack = -128;

/// For each network pixel the box of camera pixels whose mean it is.
struct RemapTable {
  int taps = 0;  ///< of the box filter, along each axis
  std::vector<uint16_t> first_col;
  std::vector<uint16_t> first_row;
  /// For each network pixel the weights of its columns, then those of its rows. Each set sums to
  /// 256, or to 0 outside the frame.
  std::vector<uint16_t> weights;
};

/// Looks through network_camera(camera) into the frames of `camera`. Each network pixel is the mean
/// of the camera pixels in a box as wide as the scale asks for (one pixel when enlarging, which is
/// bilinear interpolation). What lies outside the frame is black. The table is made once, in the
/// constructor; run() allocates nothing and may be called from several threads.
class ImagePreprocessor {
 public:
  explicit ImagePreprocessor(const CameraModel& camera);

  /// planes[c][v][u] = value - 128, R, G and B. An error when the frame is not of the size that the
  /// calibration is for; `planes` must have kNetworkImageSize values.
  Status run(const RgbView& image, std::span<int8_t> planes) const;

 private:
  int width_px_;
  int height_px_;
  RemapTable table_;
};

}  // namespace bevloc
