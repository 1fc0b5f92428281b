// From a camera's frame to the network's input: undistort, crop, resize and quantise in one pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/image_view.h"
#include "common/result.h"
#include "pipeline/preprocessing/mjpeg_decoder.h"
#include "pipeline/preprocessing/network_camera.h"
#include "pipeline/preprocessing/remap_table.h"

namespace bevloc {

/// Number of values of one network input image: planes [3, kNetworkHeightPx, kNetworkWidthPx].
inline constexpr size_t kNetworkImageSize = 3 * static_cast<size_t>(kNetworkPixels);

/// Network input of a black pixel: a camera that is missing is black throughout.
inline constexpr int8_t kNetworkBlack = -128;

/// Looks through network_camera(camera) into the frames of `camera`, of any format, as they lie in
/// the driver's memory; MJPEG alone is decoded first. Each network pixel is the mean of the camera
/// pixels in a box as wide as the scale asks for (one pixel when enlarging, which is bilinear
/// interpolation). What lies outside the frame is black. Table and decoder are made once, in the
/// constructor; run() allocates nothing but what libjpeg does. Not thread safe.
class ImagePreprocessor {
 public:
  explicit ImagePreprocessor(const CameraModel& camera);

  /// planes[c][v][u] = value - 128, R, G and B. An error when the frame is not of the size that the
  /// calibration is for, or a JPEG frame is damaged; `planes` must have kNetworkImageSize values.
  Status run(const ImageView& image, std::span<int8_t> planes);

 private:
  int width_px_;
  int height_px_;
  RemapTable table_;
  MjpegDecoder mjpeg_;
};

}  // namespace bevloc
