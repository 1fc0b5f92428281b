// The results of the paper (Miao et al., arXiv:2503.00862). They were measured on nuScenes with the
// paper's own network, so they serve for orientation only.
#pragma once

#include <vector>

#include "evaluation/solver/solver_case.h"
#include "evaluation/solver/solver_score.h"

namespace bevloc::evaluation {

/// A row of a table in the paper, and our corresponding cases.
struct PaperRow {
  const char* solver;  ///< "Full" or "Dec."
  const char* input;   ///< "S": masks, "F": features
  PerAxis mae;
  SolverCase ours;  ///< size, channels and step
  std::vector<SolverKind> our_solvers;
};

struct PaperTable {
  const char* title;
  std::vector<PaperRow> rows;
};

/// Tables III and IV.
std::vector<PaperTable> paper_tables();

}  // namespace bevloc::evaluation
