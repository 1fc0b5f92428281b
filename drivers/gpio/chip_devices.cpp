#include "drivers/gpio/chip_devices.h"

#include <algorithm>

namespace bevloc::drivers {

std::vector<std::string> gpio_chip_devices(const std::filesystem::path& dev) {
  std::vector<std::string> devices;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(dev, ignored)) {
    const bool is_chip = entry.path().filename().string().starts_with("gpiochip");
    if (is_chip && !entry.is_symlink(ignored)) devices.push_back(entry.path().string());
  }
  std::ranges::sort(devices);
  return devices;
}

}  // namespace bevloc::drivers
