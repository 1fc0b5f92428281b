// `bevloc store-answer`: stores a model's answer to the test frame in its file.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

/// Runs the model on the test frame (pipeline/network/test_frame.h) and writes the answer into the
/// metadata of its ONNX file. The appliance compares its own answer with it. Fails if the file
/// cannot be read, run or written; the file is then unchanged.
Status store_answer(const std::string& model);

class AnswerCommand {
 public:
  void declare(CLI::App& app);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.
  bool chosen() const { return chosen_; }

 private:
  bool chosen_ = false;
  std::string model_ = "models/nano.onnx";
};

}  // namespace bevloc::evaluation
