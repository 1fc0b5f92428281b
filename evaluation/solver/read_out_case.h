// Which solvers evaluate a model, and on which input.
#pragma once

#include <vector>

#include "evaluation/solver/solver_case.h"

namespace bevloc::evaluation {

/// The input that a solver matches. The paper's Table III compares the first two.
enum class SolverInput {
  kFeatures,   ///< F: the network's features of images and map
  kMasks,      ///< S: perceived mask and raster, each with its union (C = 4)
  kTrueMasks,  ///< T: like S, with the true mask (map of the world at the true pose)
};

/// "F", "S" or "T".
const char* name_of(SolverInput input);

/// A solver and its input.
struct ReadOutCase {
  SolverInput input = SolverInput::kFeatures;
  SolverCase solver_case;

  bool operator==(const ReadOutCase&) const = default;
};

/// The solver, then everything that differs from the daemon: "decoupled+refine S 400x200 0.1".
std::string label_of(const ReadOutCase& read_out);

enum class ReadOutRows {
  kSolvers,    ///< the solvers on the network's features
  kVariants,   ///< all inputs, sizes and steps of the paper's Tables III and IV
  kBaselines,  ///< no solvers: methods without learned matching
  kAll,
};

/// The solvers of these rows, without repetition.
std::vector<ReadOutCase> read_out_cases(ReadOutRows rows);

}  // namespace bevloc::evaluation
