// Connects a recorder with an appliance.
#pragma once

#include <memory>
#include <optional>

#include "firmware/recording/recorder.h"
#include "firmware/runtime/appliance.h"
#include "firmware/status/snapshot.h"

namespace bevloc::firmware {

/// Opens the recorder that the configuration asks for; null if it asks for none. The head of its
/// files has the configuration, the calibration, what was learned about it, the map if it is not
/// too large, and the checksums of model and map.
Result<std::unique_ptr<Recorder>> open_recorder(const Config& config, const Rig& rig,
                                                const HdMap& map, bool lockstep, Time now);

/// Puts taps between devices and appliance. `recorder` must outlive the hardware.
void tap(Hardware& hardware, Recorder& recorder);

/// Records matches, solutions and counters. Before the first step of the appliance; `recorder` must
/// outlive the appliance's last step.
void watch(Appliance& appliance, Recorder& recorder);

/// The recorder's totals; empty if it is null.
std::optional<RecordingSnapshot> totals_of(const Recorder* recorder);

}  // namespace bevloc::firmware
