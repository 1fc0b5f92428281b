// V4L2's names for the pixel formats that bevloc reads.
#pragma once

#include <optional>
#include <string>

#include <linux/videodev2.h>

#include "common/image_view.h"

namespace bevloc::drivers::v4l2 {

/// Four characters; trailing spaces are kept out.
std::string fourcc_name(uint32_t fourcc);

uint32_t fourcc_of(PixelFormat format);

/// How a device encodes YUV, with the defaults of videodev2.h where it does not say.
YuvEncoding yuv_encoding(const v4l2_pix_format& pixels);

/// A picture of this format whose bytes begin at `data`.
ImageView view_of(PixelFormat format, const v4l2_pix_format& pixels, const uint8_t* data);

}  // namespace bevloc::drivers::v4l2
