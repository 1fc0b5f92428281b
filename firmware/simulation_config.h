// The section `simulation` of the configuration file.
#pragma once

#include "common/strict_yaml.h"
#include "firmware/config.h"

namespace bevloc::firmware {

/// Mistakes are reported by the file's YamlMap::finish().
SimulationConfig read_simulation(YamlMap yaml);

}  // namespace bevloc::firmware
