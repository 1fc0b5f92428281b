// `bevloc record`: runs bevlocd and records it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

/// Replaces this program by the bevlocd that lies beside it, with --record. What follows `--` goes
/// to bevlocd.
class RecordCommand {
 public:
  void declare(CLI::App& app);
  /// Returns only if bevlocd cannot be started.
  Status run() const;

 private:
  std::string config_file_;
  std::string out_ = "recording";
  bool raw_ = false;
  std::vector<std::string> rest_;
};

}  // namespace bevloc::evaluation
