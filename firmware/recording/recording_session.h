// Connects a recorder with an appliance.
#pragma once

#include <memory>
#include <optional>

#include "firmware/recording/recorder.h"
#include "firmware/runtime/appliance.h"
#include "firmware/status/snapshot.h"

namespace bevloc::firmware {

/// Opens the recorder that the configuration asks for, or returns null if it asks for none. The
/// head of each file has the configuration, the calibration with the learned errors, the map if it
/// is not too large, and the checksums of model and map. Configuration, rig and DBC file are those
/// that load_config() read, although the files may have changed since.
Result<std::unique_ptr<Recorder>> open_recorder(const Config& config, const Rig& rig,
                                                const HdMap& map, bool lockstep, Time now);

/// Wraps cameras and bus so that they hand each frame to the recorder as well (taps.h). `recorder`
/// must outlive the hardware.
void tap(Hardware& hardware, Recorder& recorder);

/// Makes the appliance record matches, solutions, fixes of gpsd and counters. Call it before the
/// first step of the appliance. `recorder` must outlive the appliance's last step.
void watch(Appliance& appliance, Recorder& recorder);

/// Returns the totals of the recording that the configuration asks for, or nothing if it asks for
/// none. A null recorder could not be opened: then the recording has failed.
std::optional<RecordingSnapshot> totals_of(const Config& config, const Recorder* recorder);

}  // namespace bevloc::firmware
