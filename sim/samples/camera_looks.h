// Draws how the cameras of a sample differ from the simulator's own.
#pragma once

#include <array>
#include <cstdint>

#include "common/cameras.h"
#include "sim/render/picture_look.h"

namespace bevloc::sim {

/// Ranges of the cameras' looks. By default the pictures do not change.
struct CameraLooks {
  double cast = 0.0;              ///< largest change of a channel's gain, relative
  double least_saturation = 1.0;  ///< uniform from here ...
  double most_saturation = 1.0;   ///< ... to here
  double grey_share = 0.0;        ///< share of the samples with grey cameras
  double contrast = 0.0;          ///< largest change of contrast and gamma, relative
  double sharpness = 0.0;         ///< largest PictureLook::sharpening, and largest blur
  double smear_share = 0.0;       ///< share with motion blur of 1 or 2 pixels
  double body_share = 0.0;        ///< share with the own vehicle in the pictures
  double black_rows_share = 0.0;  ///< share with 1 to 5 black rows at the lower edge

  bool operator==(const CameraLooks&) const = default;
};

/// Narrows or widens the range of each entry by a factor; no share exceeds 1.
CameraLooks scaled(const CameraLooks& looks, double factor);

/// The looks of one sample. The cameras of a vehicle are of one kind, and differ a little.
std::array<PictureLook, kCameraCount> random_looks(const CameraLooks& looks, uint64_t seed);

}  // namespace bevloc::sim
