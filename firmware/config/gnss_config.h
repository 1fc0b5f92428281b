// The section `gnss` of the configuration file: a GNSS receiver that is not on the CAN bus.
#pragma once

#include <optional>

#include "common/strict_yaml.h"
#include "common/vehicle_samples.h"
#include "drivers/gnss/fix_clock.h"
#include "drivers/gnss/gpsd_client.h"

namespace bevloc::firmware {

struct GnssConfig {
  drivers::GpsdAddress gpsd;
  GnssSample::Antenna antenna;
  drivers::FixClockParameters clock;
  double min_sigma_m = 0.5;
};

/// Reads the section. YamlMap::finish() reports mistakes.
GnssConfig read_gnss(YamlMap& yaml);

}  // namespace bevloc::firmware
