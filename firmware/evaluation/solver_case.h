// What is evaluated: a solver on features of one size.
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
  double step_m = 0.2;  ///< of x and y; of yaw the same number of degrees

  HypothesisGrid hypotheses() const;
  bool operator==(const SolverCase& other) const;
};

/// "100x50".
std::string size_name(const BevGrid& grid);

/// Every solver at the paper's default: 100 x 50, 16 channels, steps of 0.2.
std::vector<SolverCase> variant_cases();
/// The paper's Table III: full and decoupled on masks, on 16 and on 64 channels.
std::vector<SolverCase> table_three_cases();
/// The paper's Table IV: two sizes, three steps.
std::vector<SolverCase> table_four_cases();

/// Softmax scales for hand-made features (sim/perception/mask_features.h), in the place of those
/// that training learns with a network. Each minimises the negative log-likelihood on 400 tuning
/// scenes at corruption "paper" (`bevloc tune solver`), which no evaluation sees.
SolverParameters hand_made_parameters(const SolverCase& solver_case);

}  // namespace bevloc::evaluation
