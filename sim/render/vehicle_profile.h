// The outline of a vehicle seen from its side: bodies are this outline, drawn out sideways.
#pragma once

#include <span>

#include <Eigen/Core>

#include "sim/render/texture.h"

namespace bevloc::sim {

/// A corner of the outline, from the lower rear over the roof to the lower front, in shares of the
/// length (from the rear) and of the height; and what covers the edge to the next corner.
struct ProfileCorner {
  float x;
  float z;
  Pattern face;
};

struct VehicleProfile {
  std::span<const ProfileCorner> corners;
  Pattern side;
};

const VehicleProfile& profile_of(VehicleKind kind);

/// Whether a point of the side view lies within the outline.
bool inside_profile(std::span<const ProfileCorner> corners, float x, float z);

}  // namespace bevloc::sim
