// `bevloc doctor`: what is wrong with this machine, and how to mend it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "command/doctor/finding.h"
#include "command/doctor/machine.h"
#include "common/result.h"
#include "firmware/config/config.h"

namespace bevloc::command {

/// All findings about a machine. Without a configuration (empty path) only those that need none.
/// `simulation` may be null (firmware::load_config()).
Findings examine(const Machine& machine, const std::filesystem::path& config_file,
                 const firmware::SimulationReader* simulation);

class DoctorCommand {
 public:
  explicit DoctorCommand(const firmware::SimulationReader* simulation) : simulation_(simulation) {}

  void declare(CLI::App& app);
  bool chosen() const { return chosen_; }

  /// Returns the exit code: 0 all ok, 1 warnings, 2 problems.
  Result<int> run() const;

 private:
  const firmware::SimulationReader* simulation_;
  bool chosen_ = false;
  bool json_ = false;
  std::string config_file_;
};

}  // namespace bevloc::command
