#include "command/doctor/doctor_command.h"

#include <fmt/format.h>

#include "command/doctor/config_checks.h"
#include "command/doctor/machine_checks.h"
#include "command/shell_word.h"

namespace bevloc::command {
namespace {

constexpr const char* kInstalledConfig = "/etc/bevloc/bevlocd.yaml";

void append(Findings& all, const Findings& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Findings examine(const Machine& machine, const std::filesystem::path& config_file,
                 const firmware::SimulationReader* simulation) {
  Findings all;
  if (config_file.empty()) {
    all.push_back({Level::kWarning, "configuration", "found no configuration",
                   "one, so that devices and files can be checked", "bevloc init"});
  } else if (const auto config = firmware::load_config(config_file, simulation); !config) {
    all.push_back(
        {Level::kProblem, "configuration", config.error().message,
         "a configuration without mistakes",
         fmt::format("bevlocd --config {} --check-config", shell_word(config_file.string()))});
  } else {
    all.push_back(ok("configuration", config_file.string()));
    append(all, check_files(*config));
    append(all, check_devices(machine, *config));
    append(all, check_can_interface(machine, *config));
    append(all, check_realtime(machine, *config));
  }
  append(all, check_cpu(machine));
  append(all, check_room(machine));
  append(all, check_clock(machine));
  append(all, check_unit(machine));
  return all;
}

void DoctorCommand::declare(CLI::App& app) {
  auto* doctor = app.add_subcommand(
      "doctor", "Look for what is wrong with this machine, and say how to mend it");
  doctor
      ->add_option(
          "--config", config_file_,
          fmt::format("Configuration file; without it {}, if it is there", kInstalledConfig))
      ->check(CLI::ExistingFile);
  doctor->add_flag("--json", json_, "Print the findings as JSON");
  doctor->footer(
      fmt::format("Exit code: 0 all ok, 1 warnings, 2 problems.\n"
                  "Examples:\n"
                  "  bevloc doctor --config {}\n"
                  "  bevloc doctor --json",
                  simulation_ != nullptr ? "config/demo.yaml" : "my_config.yaml"));
}

Result<int> DoctorCommand::run() const {
  const LinuxMachine machine;
  const std::string installed = machine.exists(kInstalledConfig) ? kInstalledConfig : "";
  const Findings findings =
      examine(machine, config_file_.empty() ? installed : config_file_, simulation_);
  fmt::print("{}", json_ ? to_json(findings) : to_text(findings));
  return static_cast<int>(worst_of(findings));
}

}  // namespace bevloc::command
