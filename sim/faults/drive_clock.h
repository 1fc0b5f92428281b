// Relates the time that the appliance's clock shows to the time that has passed in the world.
#pragma once

#include <span>
#include <vector>

#include "sim/faults/fault.h"

namespace bevloc::sim {

/// The time of the drive when the appliance's clock shows `elapsed_s` since the drive's start.
/// After a suspension it exceeds `elapsed_s`, because the clock does not count the suspension.
double drive_time_s(double elapsed_s, std::span<const Fault> faults);

/// Whether the appliance stood still at this time, while its clock went on.
bool is_in_clock_gap(double elapsed_s, std::span<const Fault> faults);

/// The end of the last gap that begins before or at this time, or 0 if no gap does.
double clock_gaps_end_s(double elapsed_s, std::span<const Fault> faults);

/// Converts the times of the faults from the appliance's clock to the time of the drive.
std::vector<Fault> in_drive_time(std::vector<Fault> faults, std::span<const Fault> clock_faults);

/// The time by which the drive may become longer than planned.
double added_time_s(std::span<const Fault> faults);

}  // namespace bevloc::sim
