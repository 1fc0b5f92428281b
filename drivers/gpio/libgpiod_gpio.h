// The machine's GPIO lines, by libgpiod and the kernel's character devices.
#pragma once

#include <vector>

#include "drivers/gpio/gpio.h"
#include "drivers/gpio/line_lookup.h"

namespace bevloc::drivers {

/// Works with libgpiod 1 and 2; the build uses the installed version. Each open looks for the chips
/// again, so it also finds a chip that appeared later. Needs read and write access to
/// /dev/gpiochip*.
class LibgpiodGpio final : public Gpio {
 public:
  Result<std::unique_ptr<OutputLine>> open_output(const LineAddress& address, bool active) override;
  Result<std::unique_ptr<InputLine>> open_input(const LineAddress& address) override;

  /// Returns all chips of this machine that can be opened.
  static std::vector<GpioChipInfo> chips();

  /// Checks that there is such a line, in use or not.
  Status look_for(const LineAddress& address) const;
};

}  // namespace bevloc::drivers
