#include "command/udev/udev_rules_command.h"

#include <set>

#include <fmt/format.h>

#include "drivers/gpio/libgpiod_gpio.h"

namespace bevloc::command {

Result<std::string> udev_rules(const std::vector<drivers::GpioChipInfo>& chips,
                               const std::vector<drivers::LineAddress>& lines,
                               const std::filesystem::path& sysfs) {
  std::set<std::string> devices;
  for (const drivers::LineAddress& line : lines) {
    const auto place = drivers::find_line(chips, line);
    if (!place) return tl::unexpected(place.error());
    const std::string& chip = chips[place->chip].name;
    const auto node = sysfs / "bus/gpio/devices" / chip;
    std::error_code error;
    const auto device = std::filesystem::canonical(node, error).parent_path().filename();
    if (error || device.empty()) {
      return fail("{}: found no device of this chip, wanted one of the kernel", node.string());
    }
    devices.insert(device.string());
  }
  std::string rules =
      "# /etc/udev/rules.d/60-bevloc.rules: the group bevloc may open the GPIO chips of bevlocd's\n"
      "# configuration, and no other ones. Made by `bevloc udev-rules`.\n";
  for (const std::string& device : devices) {
    rules += fmt::format(
        "SUBSYSTEM==\"gpio\", KERNEL==\"gpiochip*\", KERNELS==\"{}\", GROUP=\"bevloc\", "
        "MODE=\"0660\"\n",
        device);
  }
  if (devices.empty()) rules += "# The configuration names no GPIO line.\n";
  return rules;
}

void UdevRulesCommand::declare(CLI::App& app) {
  auto* rules = app.add_subcommand(
      "udev-rules", "Print the udev rules for the GPIO chips that a configuration names");
  rules->add_option("--config", config_file_, "Configuration of bevlocd")->required();
  rules->footer(
      "Examples:\n"
      "  bevloc udev-rules --config /etc/bevloc/bevlocd.yaml > /etc/udev/rules.d/60-bevloc.rules");
  rules->callback([this] { chosen_ = true; });
}

Status UdevRulesCommand::run() const {
  const auto config = firmware::load_config(config_file_, simulation_);
  if (!config) return tl::unexpected(config.error());
  const auto rules =
      udev_rules(drivers::LibgpiodGpio::chips(), firmware::lines_of(config->gpio), "/sys");
  if (!rules) return tl::unexpected(rules.error());
  fmt::print("{}", *rules);
  return {};
}

}  // namespace bevloc::command
