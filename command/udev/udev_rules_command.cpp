#include "command/udev/udev_rules_command.h"

#include <algorithm>
#include <fstream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/option_checks.h"
#include "common/replace_file.h"
#include "drivers/gpio/libgpiod_gpio.h"

namespace bevloc::command {
namespace {

namespace fs = std::filesystem;

/// Returns the folder where the kernel shows the chips, each as a link to a folder below its
/// device.
fs::path chip_folder(const fs::path& sysfs) {
  return sysfs / "bus/gpio/devices";
}

/// Returns the device to which the chip belongs, or an empty path if the kernel shows none.
std::string device_of(const fs::path& sysfs, const std::string& chip) {
  std::error_code error;
  const fs::path device = fs::canonical(chip_folder(sysfs) / chip, error).parent_path().filename();
  return error ? "" : device.string();
}

/// Returns the chips that KERNELS== matches: those of the device and of all devices below it.
std::vector<std::string> chips_below(const fs::path& sysfs, const std::string& device) {
  std::vector<std::string> chips;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(chip_folder(sysfs), error)) {
    const fs::path place = fs::canonical(entry.path(), error);
    if (std::ranges::find(place, fs::path(device)) != place.end()) {
      chips.push_back(entry.path().filename().string());
    }
  }
  return chips;
}

/// Returns the chip's node in the device tree. A device with several chips has a node for each. The
/// result is empty on machines without a device tree.
std::string tree_node_of(const fs::path& sysfs, const std::string& chip) {
  constexpr std::string_view kKey = "OF_FULLNAME=";
  std::ifstream events(chip_folder(sysfs) / chip / "uevent");
  for (std::string line; std::getline(events, line);) {
    if (line.starts_with(kKey)) return line.substr(kKey.size());
  }
  return "";
}

/// Returns the rule for a chip. `named` has all chips of the configuration.
std::string rule_for(const fs::path& sysfs, const std::string& chip, const std::string& device,
                     const std::set<std::string>& named) {
  std::vector<std::string> others = chips_below(sysfs, device);
  std::erase_if(others, [&](const std::string& other) { return named.contains(other); });
  const std::string node = others.empty() ? "" : tree_node_of(sysfs, chip);
  std::string rule;
  if (!others.empty() && node.empty()) {
    rule = fmt::format(
        "# The next rule also opens {} to the group: no attribute tells them from {}.\n",
        fmt::join(others, ", "), chip);
  }
  return rule + fmt::format(
                    "SUBSYSTEM==\"gpio\", KERNEL==\"gpiochip*\", KERNELS==\"{}\", {}"
                    "GROUP=\"bevloc\", MODE=\"0660\"\n",
                    device, node.empty() ? "" : fmt::format("ENV{{OF_FULLNAME}}==\"{}\", ", node));
}

}  // namespace

Result<std::string> udev_rules(const std::vector<drivers::GpioChipInfo>& chips,
                               const std::vector<drivers::LineAddress>& lines,
                               const fs::path& sysfs) {
  std::set<std::string> named;
  for (const drivers::LineAddress& line : lines) {
    const auto place = drivers::find_line(chips, line);
    if (!place) return tl::unexpected(place.error());
    named.insert(chips[place->chip].name);
  }
  std::set<std::string> rules;  // several chips of one device may have the same rule
  for (const std::string& chip : named) {
    const std::string device = device_of(sysfs, chip);
    if (device.empty()) {
      return fail("{}: found no device of this chip, wanted one of the kernel",
                  (chip_folder(sysfs) / chip).string());
    }
    rules.insert(rule_for(sysfs, chip, device, named));
  }
  if (rules.empty()) rules.insert("# The configuration names no GPIO line.\n");
  return fmt::format(
      "# /etc/udev/rules.d/60-bevloc.rules: the group bevloc may open the GPIO chips of bevlocd's\n"
      "# configuration, and no other ones. Made by `bevloc udev-rules`.\n{}",
      fmt::join(rules, ""));
}

void UdevRulesCommand::declare(CLI::App& app) {
  auto* rules = app.add_subcommand(
      "udev-rules", "Print the udev rules for the GPIO chips that a configuration names");
  rules->add_option("--config", config_file_, "Configuration of bevlocd")->required();
  rules
      ->add_option("--out", out_,
                   "File to write if there is no mistake; without it, they are printed")
      ->check(replaced_file());
  rules->footer(
      "Examples:\n"
      "  bevloc udev-rules --config my_config.yaml\n"
      "  bevloc udev-rules --config /etc/bevloc/bevlocd.yaml --out "
      "/etc/udev/rules.d/60-bevloc.rules");
}

Status UdevRulesCommand::run() const {
  if (Status status = check_output(out_, {config_file_}); !status) return status;
  const auto config = firmware::load_config(config_file_, simulation_);
  if (!config) return tl::unexpected(config.error());
  const auto rules =
      udev_rules(drivers::LibgpiodGpio::chips(), firmware::lines_of(config->gpio), "/sys");
  if (!rules) return tl::unexpected(rules.error());
  if (!out_.empty()) return replace_file(out_, *rules);
  fmt::print("{}", *rules);
  return {};
}

}  // namespace bevloc::command
