#include "evaluation/solver/draw_command.h"

#include "common/option_checks.h"
#include "evaluation/solver/solver_figures.h"

namespace bevloc::evaluation {

void DrawCommand::declare(CLI::App& draw) {
  auto* solver = draw.add_subcommand(
      "solver", "Input and output of the solvers, as in the paper's Fig. 3, 4 and 5d");
  solver->add_option("--json", json_file_, "Write the data to this file; script/figures draws it")
      ->required()
      ->check(output_file());
  solver->add_option("--scene", scene_, "Number of the scene; each kind of road has its own scenes")
      ->check(CLI::Range(uint64_t{0}, kMostFigureScenes - 1))
      ->capture_default_str();
  solver->footer(
      "Examples:\n"
      "  bevloc draw solver --scene 3 --json figures.json");
}

Status DrawCommand::run() const {
  return write_solver_figures(scene_, json_file_);
}

}  // namespace bevloc::evaluation
