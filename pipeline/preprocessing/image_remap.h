// Converts a camera image to network input: undistorts, crops, resizes and quantises in one pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/image_view.h"
#include "common/result.h"
#include "pipeline/preprocessing/mjpeg_decoder.h"
#include "pipeline/preprocessing/network_camera.h"
#include "pipeline/preprocessing/remap_table.h"

namespace bevloc {

/// Number of values of one network input image, [3, kNetworkHeightPx, kNetworkWidthPx].
inline constexpr size_t kNetworkImageSize = 3 * static_cast<size_t>(kNetworkPixels);

/// Network input of a black pixel. The whole image of a missing camera is black.
inline constexpr int8_t kNetworkBlack = -128;

/// Converts the images of `camera` to those of network_camera(camera). Reads any format directly
/// from the driver's memory; only MJPEG is decoded first. Each network pixel is the mean of the
/// camera pixels in a box whose width is the scale (one pixel if the image is enlarged, which is
/// bilinear interpolation). Pixels outside the camera image are black. Allocates in the constructor
/// only, except for the first MJPEG image and the memory that libjpeg-turbo uses per image. One
/// thread.
class ImagePreprocessor {
 public:
  explicit ImagePreprocessor(const CameraModel& camera);

  /// Writes planes[c][v][u] = value - 128 for R, G and B. `planes` must have kNetworkImageSize
  /// values. Fails if the size of the image differs from the calibration or if a JPEG is damaged.
  Status run(const ImageView& image, std::span<int8_t> planes);

  /// For each network pixel, 1 if it shows a part of the camera image, 0 if it is always black.
  std::vector<uint8_t> shown_pixels() const;

 private:
  /// Decodes MJPEG images, at a reduced size if the network needs no more, and reads the result.
  struct MjpegReader {
    explicit MjpegReader(const CameraModel& camera);
    MjpegDecoder decoder;
    RemapTable table;
  };

  CameraModel camera_;
  RemapTable table_;
  std::optional<MjpegReader> mjpeg_;  ///< made for the first MJPEG image
};

}  // namespace bevloc
