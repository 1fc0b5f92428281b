#include "drivers/gpio/chip_devices.h"

#include <fstream>

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"

namespace bevloc::drivers {
namespace {

/// A Raspberry Pi 5 has gpiochip4 as a link to gpiochip0. Both would have the same label.
TEST(GpioChipDevices, AreSortedAndWithoutLinks) {
  const test::TemporaryFolder dev;
  for (const char* name : {"gpiochip1", "gpiochip0", "gpio", "video0"}) std::ofstream{dev / name};
  std::filesystem::create_symlink("gpiochip0", dev / "gpiochip4");
  EXPECT_THAT(gpio_chip_devices(dev.path()),
              testing::ElementsAre((dev / "gpiochip0").string(), (dev / "gpiochip1").string()));
}

TEST(GpioChipDevices, OfAFolderThatIsAbsentAreNone) {
  const test::TemporaryFolder dev;
  EXPECT_TRUE(gpio_chip_devices(dev / "absent").empty());
}

}  // namespace
}  // namespace bevloc::drivers
