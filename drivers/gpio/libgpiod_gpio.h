// The machine's GPIO lines, through libgpiod and the kernel's character devices.
#pragma once

#include "drivers/gpio/gpio.h"

namespace bevloc::drivers {

/// Works with libgpiod 1 and 2; the build takes the version that is installed. Chips are looked for
/// at every open, so one that appears later is found. Needs read and write access to
/// /dev/gpiochip*.
class LibgpiodGpio final : public Gpio {
 public:
  Result<std::unique_ptr<OutputLine>> open_output(const LineAddress& address, bool active) override;
  Result<std::unique_ptr<InputLine>> open_input(const LineAddress& address) override;

  /// Whether there is such a line; one in use will do.
  Status look_for(const LineAddress& address) const;
};

}  // namespace bevloc::drivers
