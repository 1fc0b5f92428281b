// Draws camera rigs of other vehicles than the simulator's own.
#pragma once

#include <cstdint>

#include "pipeline/calibration/rig.h"

namespace bevloc::sim {

/// A rig with six cameras around a vehicle. With `variety` 0 it is nominal_rig(). With 1 the
/// cameras are about 0.6 to 2.6 m high, look about 15 degrees down to 5 degrees up, see about 50 to
/// 120 degrees, and sit anywhere between bumper and roof. Between 0 and 1 they differ in
/// proportion.
Rig random_rig(double variety, uint64_t seed);

}  // namespace bevloc::sim
