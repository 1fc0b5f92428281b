#include "firmware/evaluation/solver_case.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace bevloc::evaluation {

HypothesisGrid SolverCase::hypotheses() const {
  HypothesisGrid hypotheses;
  hypotheses.x_m.step = step_m;
  hypotheses.y_m.step = step_m;
  hypotheses.yaw_rad.step = radians(step_m);
  return hypotheses;
}

bool SolverCase::operator==(const SolverCase& other) const {
  return solver == other.solver && grid.rows == other.grid.rows && grid.cols == other.grid.cols &&
         channels == other.channels && step_m == other.step_m;
}

std::string size_name(const BevGrid& grid) {
  return fmt::format("{}x{}", grid.rows, grid.cols);
}

std::vector<SolverCase> variant_cases() {
  std::vector<SolverCase> cases;
  for (const SolverKind kind : all_solver_kinds()) cases.push_back({.solver = kind});
  return cases;
}

std::vector<SolverCase> table_three_cases() {
  std::vector<SolverCase> cases;
  for (const int channels : {3, 4, 16, 64}) {
    for (const SolverKind kind :
         {SolverKind::kFullFft, SolverKind::kDecoupledLiteral, SolverKind::kDecoupled,
          SolverKind::kDecoupledRefined, SolverKind::kBlock}) {
      cases.push_back({.solver = kind, .channels = channels});
    }
  }
  return cases;
}

std::vector<SolverCase> table_four_cases() {
  std::vector<SolverCase> cases;
  for (const BevGrid& grid : {kFeatureGrid, kRasterGrid}) {
    for (const double step_m : {0.1, 0.2, 0.4}) {
      for (const SolverKind kind :
           {SolverKind::kDecoupledLiteral, SolverKind::kDecoupled, SolverKind::kDecoupledRefined}) {
        cases.push_back({.solver = kind, .grid = grid, .step_m = step_m});
      }
    }
    cases.push_back({.solver = SolverKind::kFullFft, .grid = grid});
  }
  return cases;
}

SolverParameters hand_made_parameters(const SolverCase&) {
  SolverParameters parameters;
  return parameters;
}

}  // namespace bevloc::evaluation
