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

/// Returns the rules for the chips of these lines. `sysfs` is /sys, where the kernel tells the
/// device to which a chip belongs. The device tree tells the chips of one device apart. Where there
/// is none, a comment names the other chips. Fails if a line does not exist, or its chip has no
/// device there.
Result<std::string> udev_rules(const std::vector<drivers::GpioChipInfo>& chips,
                               const std::vector<drivers::LineAddress>& lines,
                               const std::filesystem::path& sysfs);

class UdevRulesCommand {
 public:
  explicit UdevRulesCommand(const firmware::SimulationReader* simulation)
      : simulation_(simulation) {}

  void declare(CLI::App& app);
  bool chosen() const { return chosen_; }
  Status run() const;

 private:
  const firmware::SimulationReader* simulation_;
  bool chosen_ = false;
  std::string config_file_;
  std::string out_;
};

}  // namespace bevloc::command
