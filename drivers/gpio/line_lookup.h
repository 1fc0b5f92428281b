// Finds a GPIO line by the label or name of its chip and by its name or number.
#pragma once

#include <string>
#include <vector>

#include "drivers/gpio/gpio.h"

namespace bevloc::drivers {

struct GpioLineInfo {
  std::string name;      ///< empty if the line has no name
  std::string consumer;  ///< the user of the line; empty if it is free
};

struct GpioChipInfo {
  std::string name;   ///< "gpiochip0"
  std::string label;  ///< given by the driver or the board, such as "pinctrl-bcm2711"
  std::vector<GpioLineInfo> lines;
};

struct GpioLinePlace {
  size_t chip = 0;  ///< index into the chips
  unsigned line = 0;
};

/// Finds a line, in use or not. A name takes precedence over a number. Fails unless exactly one
/// line matches; the messages are described at Gpio.
Result<GpioLinePlace> find_line(const std::vector<GpioChipInfo>& chips, const LineAddress& address);

/// Finds a line that is free. Fails also for a line in use.
Result<GpioLinePlace> find_free_line(const std::vector<GpioChipInfo>& chips,
                                     const LineAddress& address);

}  // namespace bevloc::drivers
