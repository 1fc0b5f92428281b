// `bevloc manual` and `bevloc completion`: manual pages and completion, made from the option
// tables.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "firmware/config/config.h"

namespace bevloc::command {

/// Writes bevloc.1, bevlocd.8 and bevloc.yaml.5.
class ManualCommand {
 public:
  explicit ManualCommand(const firmware::SimulationReader* simulation) : simulation_(simulation) {}

  /// `app` is the whole program and must outlive this object.
  void declare(CLI::App& app);
  Status run() const;

 private:
  const firmware::SimulationReader* simulation_;
  const CLI::App* app_ = nullptr;
  std::string folder_ = ".";
};

/// Prints a script that completes bevloc and bevlocd.
class CompletionCommand {
 public:
  /// `app` is the whole program and must outlive this object.
  void declare(CLI::App& app);
  Status run() const;

 private:
  const CLI::App* app_ = nullptr;
  std::string shell_;
};

}  // namespace bevloc::command
