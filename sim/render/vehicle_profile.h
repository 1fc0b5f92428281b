// Side outlines of vehicles. A vehicle body is its outline extruded sideways.
#pragma once

#include <span>

#include <Eigen/Core>

#include "sim/render/texture.h"

namespace bevloc::sim {

/// A corner of the outline and the texture of the edge to the next corner. Corners run from the
/// lower rear over the roof to the lower front. `x` is a share of the length from the rear, `z` a
/// share of the height.
struct ProfileCorner {
  float x;
  float z;
  Pattern face;
};

struct VehicleProfile {
  std::span<const ProfileCorner> corners;
  Pattern side;  ///< texture of both sides
};

const VehicleProfile& profile_of(VehicleKind kind);

/// Whether a point (in the same shares) lies inside the outline.
bool inside_profile(std::span<const ProfileCorner> corners, float x, float z);

}  // namespace bevloc::sim
