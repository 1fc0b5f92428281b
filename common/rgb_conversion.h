// Converts camera images to RGB, exactly but slowly: for pictures that people look at.
#pragma once

#include "common/image.h"
#include "common/image_view.h"

namespace bevloc {

/// Converts an image of any format but MJPEG into `rgb`, whose size is that of the image divided by
/// `step` and rounded down. It takes every step-th pixel of every step-th row. It converts YUV as
/// ITU-R BT.601-7 and BT.709-6 demand. It gives a Bayer pixel the colour of its block of 2 x 2
/// pixels.
void convert_to_rgb(const ImageView& image, RgbImage& rgb, int step = 1);

}  // namespace bevloc
