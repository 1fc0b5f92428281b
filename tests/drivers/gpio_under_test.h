// The GPIO lines that the conformance suite runs on.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/gpio/gpio.h"

namespace bevloc::drivers {

/// A chip with lines of these names (kGpioLines), and what stands at the other end of the wires.
struct GpioBench {
  std::unique_ptr<Gpio> gpio;
  std::string chip;
  std::function<void(const std::string& line, bool high)> drive;
  std::function<bool(const std::string& line)> high;
};

inline const std::vector<std::string> kGpioLines{"trigger", "status", "fault", "ignition"};

struct GpioImplementation {
  std::string name;
  /// A bench, or an empty one where this machine cannot have it.
  std::function<GpioBench()> make;
};

/// The mock, and libgpiod on the chip of the kernel's gpio-sim whose name (gpiochip0) the
/// environment gives as BEVLOC_TEST_GPIO. It has lines of the names above, as
/// tests/hil/guest/devices makes them.
std::vector<GpioImplementation> gpios_under_test();

}  // namespace bevloc::drivers
