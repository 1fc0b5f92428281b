// By which ways a model's frames are read out.
#pragma once

#include <vector>

#include "firmware/evaluation/solver_case.h"

namespace bevloc::evaluation {

/// What a solver matches (the first two: the paper's Table III).
enum class SolverInput {
  kFeatures,   ///< F: the network's, of images and of the map
  kMasks,      ///< S: the mask perceived and the map's raster, with their union (C = 4)
  kTrueMasks,  ///< T: S with the world's own map at the true pose in place of what is perceived
};

/// "F", "S" or "T".
const char* name_of(SolverInput input);

/// A solver with what it reads.
struct ReadOutCase {
  SolverInput input = SolverInput::kFeatures;
  SolverCase solver_case;

  bool operator==(const ReadOutCase&) const = default;
};

/// "decoupled+refine S 400x200 0.1": the solver, then what is not as the daemon has it.
std::string label_of(const ReadOutCase& read_out);

enum class ReadOutRows {
  kSolvers,    ///< the solvers on the network's features
  kVariants,   ///< all inputs, the sizes and the steps of the paper's Tables III and IV
  kBaselines,  ///< methods without learned matching, no solvers
  kAll,
};

/// The solvers of those rows, none of them twice.
std::vector<ReadOutCase> read_out_cases(ReadOutRows rows);

}  // namespace bevloc::evaluation
