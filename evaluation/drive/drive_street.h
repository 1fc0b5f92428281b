// The street of a drive that differs from the simulator's own.
#pragma once

#include <cstdint>

#include "drivers/mock/mock_scene.h"
#include "evaluation/drive/drive_config.h"

namespace bevloc::evaluation {

/// What the mock cameras show of this street.
drivers::MockStreet street_of(const StreetConfig& config, uint64_t drive_seed);

}  // namespace bevloc::evaluation
