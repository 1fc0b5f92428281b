// `bevloc udev-rules`: writes rules that give bevlocd the GPIO chips of its configuration, and no
// other ones.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "drivers/gpio/line_lookup.h"
#include "firmware/config/config.h"

namespace bevloc::command {

/// Returns the rules for the chips of these lines. `sysfs` is /sys, where the kernel shows to which
/// device a chip belongs. If a device has several chips, the rule tells them apart by their nodes
/// in the device tree. On a machine without a device tree, a comment names the other chips that the
/// rule opens. Fails if a line does not exist, or if /sys shows no device of its chip.
Result<std::string> udev_rules(const std::vector<drivers::GpioChipInfo>& chips,
                               const std::vector<drivers::LineAddress>& lines,
                               const std::filesystem::path& sysfs);

class UdevRulesCommand {
 public:
  explicit UdevRulesCommand(const firmware::SimulationReader* simulation)
      : simulation_(simulation) {}

  void declare(CLI::App& app);
  Status run() const;

 private:
  const firmware::SimulationReader* simulation_;
  std::string config_file_;
  std::string out_;
};

}  // namespace bevloc::command
