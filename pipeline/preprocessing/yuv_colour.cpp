#include "pipeline/preprocessing/yuv_colour.h"

#include <cmath>

namespace bevloc {

/// The inverse of the conversions of ITU-R BT.601-7 (2.5) and BT.709-6 (3).
RgbFromYuv rgb_from_yuv(const YuvEncoding& encoding) {
  const bool is_601 = encoding.matrix == YuvMatrix::kBt601;
  const double red = is_601 ? 0.299 : 0.2126;
  const double blue = is_601 ? 0.114 : 0.0722;
  const double green = 1.0 - red - blue;
  const double luma = encoding.full_range ? 1.0 : 255.0 / 219.0;
  const double chroma = 2.0 * (encoding.full_range ? 1.0 : 255.0 / 224.0);
  const auto fixed = [](double value) {
    return static_cast<int32_t>(std::lround(value * (1 << RgbFromYuv::kCoefficientBits)));
  };
  return {(encoding.full_range ? 0 : 16) << RgbFromYuv::kSampleBits,
          fixed(luma),
          fixed(chroma * (1.0 - red)),
          fixed(chroma * (1.0 - blue) * blue / green),
          fixed(chroma * (1.0 - red) * red / green),
          fixed(chroma * (1.0 - blue))};
}

}  // namespace bevloc
