// Converts pixel formats and image layouts of V4L2.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <linux/videodev2.h>

#include "common/image_view.h"
#include "common/result.h"

namespace bevloc::drivers::v4l2 {

/// Returns the name of a format: up to four characters, without trailing spaces.
std::string fourcc_name(uint32_t fourcc);

uint32_t fourcc_of(PixelFormat format);

/// Returns whether an image of this field order (V4L2_FIELD_*) is a full image whose rows all
/// belong to one time. The kernel's documentation forbids drivers to answer V4L2_FIELD_ANY. A
/// driver that does so anyway does not know field orders, so its images count as progressive.
bool is_progressive(uint32_t field);

/// Returns the name of a field order for messages, such as "interlaced".
std::string_view field_name(uint32_t field);

/// Fails if images of the two formats differ in pixel format, size, bytes per row or field order.
/// `negotiated` is what the device agreed to, and `found` what it has after its controls were set:
/// a flip may change the Bayer order, and a rotation swaps width and height.
Status check_same_layout(const v4l2_pix_format& negotiated, const v4l2_pix_format& found);

/// Returns how a device encodes YUV. Uses the defaults of videodev2.h for unspecified values.
YuvEncoding yuv_encoding(const v4l2_pix_format& pixels);

/// Returns a view of an image of this format whose bytes begin at `data`.
ImageView view_of(PixelFormat format, const v4l2_pix_format& pixels, const uint8_t* data);

}  // namespace bevloc::drivers::v4l2
