// Pictures in files: PNG and JPEG.
#pragma once

#include <string>

#include "common/image.h"
#include "common/result.h"

namespace bevloc {

/// Into `image`, whose size is the one that is wanted; after an error its pixels are undefined.
/// PNG of any kind (grey becomes RGB, 16 bits become 8, transparent becomes black) and JPEG, told
/// apart by their first bytes.
Status read_picture(const std::string& path, RgbImage& image);

Status write_png(const RgbView& image, const std::string& path);

}  // namespace bevloc
