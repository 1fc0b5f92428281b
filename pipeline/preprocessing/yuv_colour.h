// Fixed-point conversion from YUV to RGB.
#pragma once

#include <cstdint>

#include "common/image_view.h"

namespace bevloc {

/// RGB = luma * (Y - black) + (red_v * V, -green_u * U - green_v * V, blue_u * U), where U and V
/// are 0 for grey. Coefficients have kCoefficientBits fractional bits and fit into 16 bits. Samples
/// have kSampleBits fractional bits.
struct RgbFromYuv {
  static constexpr int kSampleBits = 8;
  static constexpr int kCoefficientBits = 12;

  int32_t black;
  int32_t luma;
  int32_t red_v;
  int32_t green_u;
  int32_t green_v;
  int32_t blue_u;
};

RgbFromYuv rgb_from_yuv(const YuvEncoding& encoding);

}  // namespace bevloc
