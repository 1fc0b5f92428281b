// The configuration of a short drive with faults, without a file.
#pragma once

#include <vector>

#include "evaluation/drive/drive_config.h"

namespace bevloc::test {

inline evaluation::DriveConfig drive_with_faults(const std::vector<sim::Fault>& faults) {
  evaluation::DriveConfig config;
  config.cameras.rate_hz = 10.0;
  config.simulation.emplace();
  config.simulation->seed = 2005;
  config.simulation->town_seed = 2005;
  config.simulation->duration_s = 20.0;
  config.simulation->faults = faults;
  return config;
}

}  // namespace bevloc::test
