#include "firmware/evaluation/draw_command.h"

#include "firmware/evaluation/solver_figures.h"

namespace bevloc::evaluation {

void DrawCommand::declare(CLI::App& draw) {
  auto* solver = draw.add_subcommand(
      "solver", "What the solvers read and answer, as the paper's Fig. 3, 4 and 5d");
  solver->add_option("--out", folder_, "Folder of the pictures; made if it is not there")
      ->required();
  solver->add_option("--scene", scene_, "Which scene of each kind of road")
      ->check(CLI::Range(uint64_t{0}, kMostFigureScenes - 1))
      ->capture_default_str();
}

Status DrawCommand::run() const {
  return draw_solver_figures(scene_, folder_);
}

}  // namespace bevloc::evaluation
