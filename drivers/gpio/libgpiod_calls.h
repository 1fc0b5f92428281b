// What is asked of libgpiod. Most of it differs between the versions: libgpiod_1.cpp or
// libgpiod_2.cpp is built.
#pragma once

#include <memory>
#include <string>

#include "drivers/gpio/line_lookup.h"

struct gpiod_chip;

namespace bevloc::drivers {

/// Whom others see using our lines (gpioinfo shows it).
inline constexpr const char* kGpioConsumer = "bevloc";

struct GpioChipCloser {
  void operator()(gpiod_chip* chip) const;
};
using GpioChipHandle = std::unique_ptr<gpiod_chip, GpioChipCloser>;

/// libgpiod's names are null where there is none.
inline std::string text_or_empty(const char* text) {
  return text == nullptr ? "" : text;
}

GpioChipInfo info_of(gpiod_chip& chip);

/// Both take the chip over; `address` is for the messages and says what active means.
Result<std::unique_ptr<OutputLine>> request_output(GpioChipHandle chip, unsigned line,
                                                   const LineAddress& address, bool active);
Result<std::unique_ptr<InputLine>> request_input(GpioChipHandle chip, unsigned line,
                                                 const LineAddress& address);

}  // namespace bevloc::drivers
