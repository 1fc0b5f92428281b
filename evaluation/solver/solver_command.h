// `bevloc eval solver` and `bevloc tune solver`: their options, and their execution.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/solver/solver_case.h"
#include "evaluation/solver/solver_evaluation.h"

namespace bevloc::evaluation {

class SolverCommand {
 public:
  void declare(CLI::App& eval, CLI::App& tune);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names one of these commands.

 private:
  enum class Rows { kVariants, kTableThree, kTableFour, kAll };

  void declare_eval(CLI::App& eval);
  void declare_tune(CLI::App& tune);

  Status evaluate() const;
  Status tune() const;
  std::vector<SolverCase> cases() const;
  std::vector<SolverCase> cases_to_tune() const;
  void declare_rows(CLI::App& command);

  bool tunes_ = false;
  int scenes_ = 200;
  uint64_t seed_ = 1;
  sim::CorruptionLevel corruption_ = sim::CorruptionLevel::kPaper;
  Rows rows_ = Rows::kAll;
  std::string json_file_;
  std::string csv_file_;
};

}  // namespace bevloc::evaluation
