// What the paper measured (Miao et al., arXiv:2503.00862), on nuScenes with its own network: other
// scenes than ours, so its figures stand beside ours for orientation alone.
#pragma once

#include <vector>

#include "firmware/evaluation/solver_case.h"
#include "firmware/evaluation/solver_score.h"

namespace bevloc::evaluation {

/// A row of the paper, and our cases that lie beside it.
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
