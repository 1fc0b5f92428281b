// The part of libgpiod that differs between its versions: libgpiod_1.cpp or libgpiod_2.cpp is
// built.
#pragma once

#include <memory>

#include "drivers/gpio/line_lookup.h"

struct gpiod_chip;

namespace bevloc::drivers {

/// Whom others see using our lines (gpioinfo shows it).
inline constexpr const char* kGpioConsumer = "bevloc";

struct GpioChipCloser {
  void operator()(gpiod_chip* chip) const;
};
using GpioChipHandle = std::unique_ptr<gpiod_chip, GpioChipCloser>;

/// Null, with errno, where `device` cannot be opened.
GpioChipHandle open_gpio_chip(const std::string& device);

GpioChipInfo info_of(gpiod_chip& chip);

/// Both take the chip over; `address` is for the messages and says what active means.
Result<std::unique_ptr<OutputLine>> request_output(GpioChipHandle chip, unsigned line,
                                                   const LineAddress& address, bool active);
Result<std::unique_ptr<InputLine>> request_input(GpioChipHandle chip, unsigned line,
                                                 const LineAddress& address);

}  // namespace bevloc::drivers
