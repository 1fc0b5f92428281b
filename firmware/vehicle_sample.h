// From what the bus says about the vehicle to what the tracker reads.
#pragma once

#include <optional>
#include <variant>

#include "can/vehicle_input.h"
#include "pipeline/tracker/tracker.h"

namespace bevloc::firmware {

/// One checked reading of the vehicle's own sensors.
using VehicleSample = std::variant<OdometrySample, GnssSample>;

/// Nothing when the frame completed no sample.
std::optional<VehicleSample> tracker_sample(const can::VehicleSample& sample);

/// Hands a sample to the tracker; says whether it took it.
bool feed(Tracker& tracker, const VehicleSample& sample);

}  // namespace bevloc::firmware
