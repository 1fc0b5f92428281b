// Lists the device nodes of GPIO chips.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bevloc::drivers {

/// Returns DEV/gpiochip0, DEV/gpiochip1 and so on, sorted. Symbolic links are left out, as
/// gpiodetect does it: some boards have one for programs that know an older name of the chip.
std::vector<std::string> gpio_chip_devices(const std::filesystem::path& dev = "/dev");

}  // namespace bevloc::drivers
