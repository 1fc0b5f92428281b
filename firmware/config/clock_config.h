// The section `clock` of the configuration file: what sets the system clock of this machine.
#pragma once

#include <optional>

#include "can/messages/pose_report.h"
#include "common/strict_yaml.h"
#include "common/time.h"

namespace bevloc::firmware {

struct ClockConfig {
  can::TimeSource source = can::TimeSource::kFreeRunning;
  Duration max_error = std::chrono::milliseconds(10);
};

ClockConfig read_clock_section(std::optional<YamlMap> yaml);

}  // namespace bevloc::firmware
