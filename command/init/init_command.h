// `bevloc init`: writes a configuration for this machine and checks it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "command/command_list.h"
#include "command/init/answers.h"
#include "command/init/dialog.h"
#include "command/init/offers.h"
#include "common/result.h"
#include "firmware/config/config.h"

namespace bevloc::command {

class InitCommand {
 public:
  explicit InitCommand(const firmware::SimulationReader* simulation) : simulation_(simulation) {}

  void declare(CLI::App& app);

  /// Runs the command. The verdict is bad if the configuration was written but --check-config would
  /// refuse it.
  Result<Verdict> run() const;

  /// Does the same with other devices and another terminal.
  Result<Verdict> run(const Offers& offers, Dialog& dialog) const;

 private:
  Result<Answers> answers(const Offers& offers, Dialog& dialog) const;
  Result<std::string> driver(const Offers& offers, Dialog& dialog) const;
  Status cameras(const std::vector<OfferedCamera>& offered, Dialog& dialog, Answers& answers) const;
  Result<std::string> can(const Offers& offers, Dialog& dialog, const std::string& driver) const;

  const firmware::SimulationReader* simulation_;
  bool yes_ = false;
  bool force_ = false;
  std::string out_ = "bevlocd.yaml";
  std::string driver_;
  std::vector<std::string> ids_;
  std::string rig_;
  std::string map_;
  std::string model_;
  std::string can_;
};

}  // namespace bevloc::command
