// How the vehicle's body is tilted and lifted against its pose on the ground.
#pragma once

namespace bevloc::sim {

/// Motion of the body on its springs, relative to the pose on the flat ground.
struct BodyMotion {
  double pitch_rad = 0.0;  ///< positive if the nose is down
  double roll_rad = 0.0;   ///< positive if the right side is down
  double lift_m = 0.0;     ///< positive upwards
};

}  // namespace bevloc::sim
