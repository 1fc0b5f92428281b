// The colour conversion of YUV pictures, in fixed point.
#pragma once

#include <cstdint>

#include "common/image_view.h"

namespace bevloc {

/// RGB = luma * (Y - black) + (red_v * V, -green_u * U - green_v * V, blue_u * U). Coefficients
/// have kCoefficientBits of fraction and fit into 16 bits; samples have kSampleBits, and U and V
/// are 0 where there is no colour.
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
