// `bevloc report`: makes one HTML page of a recording.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

class ReportCommand {
 public:
  void declare(CLI::App& app);
  Status run() const;

 private:
  std::vector<std::filesystem::path> files_;
  std::filesystem::path out_ = "report.html";
  std::vector<std::string> moments_;
};

}  // namespace bevloc::evaluation
