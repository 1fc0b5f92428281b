// Reads a fault of the simulated appliance from the configuration.
#pragma once

#include "common/strict_yaml.h"
#include "sim/faults/fault.h"

namespace bevloc::evaluation {

/// Reads one entry of `simulation.faults`: its kind, time, cameras, and the amounts of its kind.
sim::Fault read_fault(YamlMap& yaml);

}  // namespace bevloc::evaluation
