#include "drivers/gpio/libgpiod_gpio.h"

#include <cerrno>
#include <cstring>

#include <gpiod.h>

#include "drivers/gpio/chip_devices.h"
#include "drivers/gpio/libgpiod_calls.h"

namespace bevloc::drivers {
namespace {

/// All chips that can be opened, and error messages for the others.
struct Chips {
  std::vector<GpioChipHandle> handles;
  std::vector<GpioChipInfo> infos;
  std::string errors;
};

struct FoundLine {
  GpioChipHandle chip;
  unsigned line = 0;
};

/// Returns null and sets errno if `device` cannot be opened.
GpioChipHandle open_chip(const std::string& device) {
  return GpioChipHandle(gpiod_chip_open(device.c_str()));
}

Chips open_chips() {
  Chips chips;
  for (const std::string& device : gpio_chip_devices()) {
    GpioChipHandle chip = open_chip(device);
    if (!chip) {
      chips.errors += fmt::format("; {} cannot be opened: {}", device, std::strerror(errno));
      continue;
    }
    chips.infos.push_back(info_of(*chip));
    chips.handles.push_back(std::move(chip));
  }
  return chips;
}

Result<FoundLine> find(const LineAddress& address) {
  Chips chips = open_chips();
  const auto place = find_free_line(chips.infos, address);
  if (!place) return fail("{}{}", place.error().message, chips.errors);
  return FoundLine{std::move(chips.handles[place->chip]), place->line};
}

}  // namespace

void GpioChipCloser::operator()(gpiod_chip* chip) const {
  gpiod_chip_close(chip);
}

Result<std::unique_ptr<OutputLine>> LibgpiodGpio::open_output(const LineAddress& address,
                                                              bool active) {
  auto found = find(address);
  if (!found) return tl::unexpected(found.error());
  return request_output(std::move(found->chip), found->line, address, active);
}

Result<std::unique_ptr<InputLine>> LibgpiodGpio::open_input(const LineAddress& address) {
  auto found = find(address);
  if (!found) return tl::unexpected(found.error());
  return request_input(std::move(found->chip), found->line, address);
}

std::vector<GpioChipInfo> LibgpiodGpio::chips() {
  return open_chips().infos;
}

Status LibgpiodGpio::look_for(const LineAddress& address) const {
  const Chips chips = open_chips();
  const auto place = find_line(chips.infos, address);
  if (!place) return fail("{}{}", place.error().message, chips.errors);
  return {};
}

}  // namespace bevloc::drivers
