// The cases of the solver evaluation: a solver with its grid, channels and step.
#pragma once

#include <string>
#include <vector>

#include "pipeline/solver/solver_factory.h"

namespace bevloc::evaluation {

/// One row of a table.
struct SolverCase {
  SolverKind solver = SolverKind::kDecoupledRefined;
  BevGrid grid = kFeatureGrid;
  int channels = 16;
  double step_m = 0.2;  ///< of x and y; the step of yaw is as many degrees

  HypothesisGrid hypotheses() const;
  bool operator==(const SolverCase& other) const;
};

/// "100x50".
std::string size_name(const BevGrid& grid);

/// Every solver with the paper's defaults: 100 x 50 cells, 16 channels, steps of 0.2.
std::vector<SolverCase> variant_cases();
/// The paper's Table III: full and decoupled solvers on masks, 16 channels and 64 channels.
std::vector<SolverCase> table_three_cases();
/// The paper's Table IV: two sizes, three steps.
std::vector<SolverCase> table_four_cases();

/// Softmax scales for hand-made features (sim/perception/mask_features.h); a network's scales are
/// learned in training. Each minimises the negative log-likelihood on 400 tuning scenes with
/// corruption "paper" (`bevloc tune solver`). No evaluation uses these scenes.
SolverParameters hand_made_parameters(const SolverCase& solver_case);

}  // namespace bevloc::evaluation
