// How cameras differ in colour, contrast and sharpness, and what they see of their own vehicle.
#pragma once

#include <array>

#include "common/image.h"

namespace bevloc::sim {

/// The part of a picture that shows the own vehicle: everything below a parabola.
struct Bodywork {
  float left = 0.0F;  ///< height at the left, middle and right, as shares of the picture's height
  float middle = 0.0F;
  float right = 0.0F;
  std::array<float, 3> colour{40.0F, 40.0F, 40.0F};  ///< 8-bit steps
  float shine = 0.3F;                                ///< share of the reflected picture

  bool is_visible() const { return left > 0.0F || middle > 0.0F || right > 0.0F; }
};

/// By default a picture does not change.
struct PictureLook {
  std::array<float, 3> gain{1.0F, 1.0F, 1.0F};  ///< factors on red, green and blue
  float saturation = 1.0F;                      ///< 0 is grey
  float contrast = 1.0F;                        ///< around a medium grey
  float gamma = 1.0F;                           ///< below 1 brightens the shadows
  float sharpening = 0.0F;                      ///< weight of sharpening; below 0 it blurs
  int smear_px = 0;                             ///< motion blur along the rows, to either side
  int black_rows = 0;                           ///< number of black rows at the lower edge
  Bodywork bodywork{};
};

/// Applies the look in the order of light: bodywork, smear and sharpness, colours, black rows.
void apply(const PictureLook& look, RgbImage& image);

}  // namespace bevloc::sim
