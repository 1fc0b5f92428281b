// `bevloc store-answer`: stores a model's answer to the test frame in its file.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

class AnswerCommand {
 public:
  void declare(CLI::App& app);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.

 private:
  std::string model_ = "models/nano.onnx";
};

}  // namespace bevloc::evaluation
