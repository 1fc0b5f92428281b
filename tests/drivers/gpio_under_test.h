// The GPIO chips on which the conformance suite runs.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/gpio/gpio.h"

namespace bevloc::drivers {

/// A chip with lines of the names kGpioLines, and access to the other end of the wires.
struct GpioBench {
  std::unique_ptr<Gpio> gpio;
  std::string chip;
  std::function<void(const std::string& line, bool high)> drive;  ///< sets the voltage of an input
  std::function<bool(const std::string& line)> high;              ///< reads the voltage
  /// Why the chip that BEVLOC_TEST_GPIO names cannot be tested. Empty if it can, or if nobody named
  /// a chip.
  std::string refusal{};
};

inline const std::vector<std::string> kGpioLines{"trigger", "status", "fault", "ignition"};

struct GpioImplementation {
  std::string name;
  /// Makes a bench; an empty one if the chip is not available on this machine.
  std::function<GpioBench()> make;
};

/// Returns the mock, and libgpiod on a chip of the kernel's gpio-sim. The environment variable
/// BEVLOC_TEST_GPIO gives the name of the chip (gpiochip0). Its lines must have the names
/// kGpioLines, as tests/hil/guest/devices creates them.
std::vector<GpioImplementation> gpios_under_test();

}  // namespace bevloc::drivers
