// Reads PNG and JPEG files, and writes PNG files.
#pragma once

#include <string>

#include "common/image.h"
#include "common/result.h"

namespace bevloc {

/// Reads a PNG or JPEG file into `image`. The file must have the size of `image`. After an error
/// the pixels of `image` are undefined. The first bytes of the file decide between PNG and JPEG. In
/// a PNG, grey becomes RGB, 16 bits become 8 bits, and transparent pixels become black.
Status read_image(const std::string& path, RgbImage& image);

/// The same for the picture of a camera of a rig: `image` has the size that the rig states. Refuses
/// a JPEG that a viewer would turn (exif_orientation.h), because nothing says whether the
/// calibration is of the turned pixels.
Status read_camera_picture(const std::string& path, RgbImage& image);

/// Creates or replaces the file `path`.
Status write_png(const RgbView& image, const std::string& path);

}  // namespace bevloc
