// Finds a GPIO line by what a person calls it.
#pragma once

#include <string>
#include <vector>

#include "drivers/gpio/gpio.h"

namespace bevloc::drivers {

struct GpioLineInfo {
  std::string name;      ///< empty for a line without one
  std::string consumer;  ///< who uses it; empty when it is free
};

struct GpioChipInfo {
  std::string name;   ///< "gpiochip0"
  std::string label;  ///< of the driver or the board
  std::vector<GpioLineInfo> lines;
};

struct GpioLinePlace {
  size_t chip = 0;  ///< index into the chips
  unsigned line = 0;
};

/// Names win over numbers. Fails, as Gpio says, where there is not exactly one such line.
Result<GpioLinePlace> find_line(const std::vector<GpioChipInfo>& chips, const LineAddress& address);

/// The same; fails for a line in use too.
Result<GpioLinePlace> find_free_line(const std::vector<GpioChipInfo>& chips,
                                     const LineAddress& address);

}  // namespace bevloc::drivers
