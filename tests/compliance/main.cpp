// bevloc-compliance --can can0 runs the conformance suites on the interfaces of this machine. It
// also accepts GoogleTest's options, such as --gtest_filter. It skips and names what is not
// available, and fails if that is what the user named.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "tests/compliance/camera_options.h"

int main(int argc, char** argv) {
  CLI::App app("Runs bevloc's conformance suites on the interfaces of this machine.");
  std::string can;
  app.add_option("--can", can, "CAN interface that no other program uses, such as vcan0");
  std::string gpio;
  app.add_option("--gpio", gpio,
                 "Chip of the kernel's gpio-sim with the lines of the lab, such as gpiochip0");
  bevloc::drivers::CameraOptions cameras(app);
  app.allow_extras();
  CLI11_PARSE(app, argc, argv);
  cameras.apply();
  // Set before GoogleTest starts, because then the suites list their implementations.
  if (!can.empty()) setenv("BEVLOC_TEST_CAN", can.c_str(), 1);
  if (!gpio.empty()) setenv("BEVLOC_TEST_GPIO", gpio.c_str(), 1);

  std::vector<std::string> rest = {argv[0]};
  for (const std::string& option : app.remaining()) rest.push_back(option);
  std::vector<char*> arguments;
  for (std::string& option : rest) arguments.push_back(option.data());
  arguments.push_back(nullptr);
  int count = static_cast<int>(rest.size());
  testing::InitGoogleTest(&count, arguments.data());
  if (count > 1) {
    std::fprintf(stderr,
                 "bevloc-compliance: found %s, wanted an option that --help lists, or one "
                 "of GoogleTest (--gtest_...)\n",
                 arguments[1]);
    return 2;
  }
  return RUN_ALL_TESTS();
}
