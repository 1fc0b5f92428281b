#include "sim/render/picture_look.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace bevloc::sim {
namespace {

constexpr float kMediumGrey = 110.0F;
/// The reflection on the bodywork is compressed by this factor.
constexpr float kReflectedRows = 3.0F;

uint8_t to_step(float value) {
  return static_cast<uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
}

/// The row at which the bodywork begins in each column.
int first_row(const Bodywork& bodywork, int column, const RgbImage& image) {
  const float x = 2.0F * static_cast<float>(column) / static_cast<float>(image.width - 1) - 1.0F;
  const float slope = 0.5F * (bodywork.right - bodywork.left);
  const float bend = 0.5F * (bodywork.right + bodywork.left) - bodywork.middle;
  const float height = bodywork.middle + slope * x + bend * x * x;
  const float rows = std::clamp(height, 0.0F, 1.0F) * static_cast<float>(image.height);
  return image.height - static_cast<int>(std::lround(rows));
}

void draw_bodywork(const Bodywork& bodywork, RgbImage& image) {
  for (int column = 0; column < image.width; ++column) {
    const int edge = first_row(bodywork, column, image);
    for (int row = edge; row < image.height; ++row) {
      const auto depth = static_cast<float>(row - edge);
      const int mirrored = std::max(0, edge - 1 - static_cast<int>(kReflectedRows * depth));
      const float shade = 1.0F - 0.5F * depth / static_cast<float>(image.height - edge);
      const uint8_t* seen = image.row(mirrored) + 3 * column;
      uint8_t* pixel = image.row(row) + 3 * column;
      for (int colour = 0; colour < 3; ++colour) {
        const float paint = shade * bodywork.colour[colour];
        pixel[colour] =
            to_step(paint + bodywork.shine * (static_cast<float>(seen[colour]) - paint));
      }
    }
  }
}

void smear(int reach_px, RgbImage& image) {
  std::vector<float> row_sum(static_cast<size_t>(image.width));
  for (int row = 0; row < image.height; ++row) {
    uint8_t* pixels = image.row(row);
    for (int colour = 0; colour < 3; ++colour) {
      for (int column = 0; column < image.width; ++column) {
        float sum = 0.0F;
        for (int offset = -reach_px; offset <= reach_px; ++offset) {
          const int from = std::clamp(column + offset, 0, image.width - 1);
          sum += static_cast<float>(pixels[3 * from + colour]);
        }
        row_sum[column] = sum / static_cast<float>(2 * reach_px + 1);
      }
      for (int column = 0; column < image.width; ++column) {
        pixels[3 * column + colour] = to_step(row_sum[column]);
      }
    }
  }
}

void sharpen(float weight, RgbImage& image) {
  const RgbImage before = image;
  const int stride = 3 * image.width;
  for (int row = 1; row + 1 < image.height; ++row) {
    const uint8_t* from = before.row(row);
    uint8_t* to = image.row(row);
    for (int i = 3; i + 3 < stride; ++i) {
      const auto near =
          static_cast<float>(from[i - 3] + from[i + 3] + from[i - stride] + from[i + stride]);
      const auto own = static_cast<float>(from[i]);
      to[i] = to_step(own + weight * (own - 0.25F * near));
    }
  }
}

/// Gain, contrast and gamma of one channel, for each of its values.
std::array<float, 256> tone_curve(const PictureLook& look, float gain) {
  std::array<float, 256> curve{};
  for (int value = 0; value < 256; ++value) {
    const float lit = std::min(gain * static_cast<float>(value) / 255.0F, 1.0F);
    const float bent = 255.0F * std::pow(lit, look.gamma);
    curve[value] = std::clamp(kMediumGrey + look.contrast * (bent - kMediumGrey), 0.0F, 255.0F);
  }
  return curve;
}

void colour(const PictureLook& look, RgbImage& image) {
  const std::array<std::array<float, 256>, 3> curves{tone_curve(look, look.gain[0]),
                                                     tone_curve(look, look.gain[1]),
                                                     tone_curve(look, look.gain[2])};
  const size_t count = static_cast<size_t>(image.width) * image.height;
  for (size_t i = 0; i < count; ++i) {
    uint8_t* pixel = &image.pixels[3 * i];
    const float red = curves[0][pixel[0]];
    const float green = curves[1][pixel[1]];
    const float blue = curves[2][pixel[2]];
    const float grey = 0.299F * red + 0.587F * green + 0.114F * blue;
    pixel[0] = to_step(grey + look.saturation * (red - grey));
    pixel[1] = to_step(grey + look.saturation * (green - grey));
    pixel[2] = to_step(grey + look.saturation * (blue - grey));
  }
}

}  // namespace

void apply(const PictureLook& look, RgbImage& image) {
  if (look.bodywork.is_visible()) draw_bodywork(look.bodywork, image);
  if (look.smear_px > 0) smear(look.smear_px, image);
  if (look.sharpening != 0.0F) sharpen(look.sharpening, image);
  colour(look, image);
  for (int row = image.height - look.black_rows; row < image.height; ++row) {
    std::fill_n(image.row(row), 3 * image.width, uint8_t{0});
  }
}

}  // namespace bevloc::sim
