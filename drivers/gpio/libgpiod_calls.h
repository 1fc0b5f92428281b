// The calls to libgpiod that differ between its versions. Either libgpiod_1.cpp or libgpiod_2.cpp
// is built.
#pragma once

#include <memory>
#include <string>

#include "drivers/gpio/line_lookup.h"

struct gpiod_chip;

namespace bevloc::drivers {

struct GpioChipCloser {
  void operator()(gpiod_chip* chip) const;
};
using GpioChipHandle = std::unique_ptr<gpiod_chip, GpioChipCloser>;

/// Returns an empty text for null, which libgpiod returns for a missing name.
inline std::string text_or_empty(const char* text) {
  return text == nullptr ? "" : text;
}

GpioChipInfo info_of(gpiod_chip& chip);

/// Both functions take ownership of the chip. `address` gives the polarity and is used in messages.
Result<std::unique_ptr<OutputLine>> request_output(GpioChipHandle chip, unsigned line,
                                                   const LineAddress& address, bool active);
Result<std::unique_ptr<InputLine>> request_input(GpioChipHandle chip, unsigned line,
                                                 const LineAddress& address);

}  // namespace bevloc::drivers
