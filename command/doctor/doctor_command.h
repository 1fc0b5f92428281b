// `bevloc doctor`: says what is wrong with this machine, and how to mend it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "command/doctor/finding.h"
#include "command/doctor/machine.h"
#include "common/result.h"
#include "firmware/config/config.h"

namespace bevloc::command {

/// Returns all findings about a machine. If there is no configuration (empty path), returns only
/// those that need none. `simulation` may be null (firmware::load_config()).
Findings examine(const Machine& machine, const std::filesystem::path& config_file,
                 const firmware::SimulationReader* simulation);

class DoctorCommand {
 public:
  explicit DoctorCommand(const firmware::SimulationReader* simulation) : simulation_(simulation) {}

  void declare(CLI::App& app);

  /// Returns the exit code: 0 if all is ok, 1 for warnings, 2 for problems.
  Result<int> run() const;

 private:
  const firmware::SimulationReader* simulation_;
  bool json_ = false;
  std::string config_file_;
};

}  // namespace bevloc::command
