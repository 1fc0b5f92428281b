#include "tests/drivers/gpio_under_test.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "drivers/gpio/libgpiod_gpio.h"
#include "tests/support/mock_gpio.h"

namespace bevloc::drivers {
namespace {

using test::MockGpio;

GpioBench mock_bench() {
  static MonotonicClock clock;
  auto gpio = std::make_unique<MockGpio>(kGpioLines, clock);
  MockGpio* const mock = gpio.get();
  return {std::move(gpio), MockGpio::kChip,
          [mock](const std::string& line, bool high) { mock->drive(line, high); },
          [mock](const std::string& line) { return mock->high(line); }};
}

/// Returns the folder in which gpio-sim shows the wires of its lines. Empty if there is no such
/// chip.
std::filesystem::path simulated_wires(const std::string& chip) {
  std::error_code none;
  for (const auto& device : std::filesystem::directory_iterator("/sys/devices/platform", none)) {
    const std::filesystem::path wires = device.path() / chip;
    const bool simulated = device.path().filename().string().starts_with("gpio-sim.");
    if (simulated && std::filesystem::exists(wires)) return wires;
  }
  return {};
}

std::filesystem::path wire_of(const std::filesystem::path& wires, const std::string& line) {
  const auto number = std::ranges::find(kGpioLines, line) - kGpioLines.begin();
  return wires / ("sim_gpio" + std::to_string(number));
}

GpioBench refused(const std::string& chip) {
  const Status found = LibgpiodGpio().look_for({chip, kGpioLines[0]});
  GpioBench bench;
  bench.refusal = found ? chip + ": found a chip of the machine, wanted one of gpio-sim"
                        : found.error().message;
  return bench;
}

GpioBench kernel_bench() {
  const char* const chip = std::getenv("BEVLOC_TEST_GPIO");
  if (chip == nullptr) return {};
  const std::filesystem::path wires = simulated_wires(chip);
  if (wires.empty()) return refused(chip);
  return {std::make_unique<LibgpiodGpio>(), chip,
          [wires](const std::string& line, bool high) {
            std::ofstream(wire_of(wires, line) / "pull") << (high ? "pull-up" : "pull-down");
          },
          [wires](const std::string& line) {
            int value = 0;
            std::ifstream(wire_of(wires, line) / "value") >> value;
            return value == 1;
          }};
}

}  // namespace

std::vector<GpioImplementation> gpios_under_test() {
  return {{"Mock", mock_bench}, {"Libgpiod", kernel_bench}};
}

}  // namespace bevloc::drivers
