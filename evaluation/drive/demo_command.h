// `bevloc demo`: the demo's drive, wherever bevloc is installed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

/// The demo's configuration for programs in `folder`: installed in PREFIX/libexec/bevloc-sim it is
/// PREFIX/share/bevloc/config/demo.yaml, built in build/PRESET/bin it is that of the source tree.
/// Fails if neither exists.
Result<std::filesystem::path> demo_config(const std::filesystem::path& folder);

/// Replaces itself by bevlocd with the demo's configuration.
class DemoCommand {
 public:
  void declare(CLI::App& app);
  bool chosen() const { return chosen_; }
  Status run() const;

 private:
  bool chosen_ = false;
  std::vector<std::string> rest_;
};

}  // namespace bevloc::evaluation
