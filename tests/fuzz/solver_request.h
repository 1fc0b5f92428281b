// Draws random arguments for make_solver(), valid and invalid.
#pragma once

#include <random>
#include <string>

#include "pipeline/solver/solver_factory.h"

namespace bevloc::fuzz {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}
/// Uniform in low ... high, both inclusive.
inline int integer(Random& random, int low, int high) {
  return std::uniform_int_distribution(low, high)(random);
}
/// Uniform in the logarithm.
double log_uniform(Random& random, double low, double high);

/// Whether make_solver() must accept the arguments.
enum class Acceptance { kMust, kMay, kMustNot };

struct SolverRequest {
  SolverKind kind{};
  BevGrid grid;
  int channels = 0;
  HypothesisGrid hypotheses;
  SolverParameters parameters;
  Acceptance acceptance = Acceptance::kMust;
  std::string culprit;  ///< text that the error message must contain; empty for valid arguments
};

/// Draws small grids, so that a million solves are cheap. Solver kinds that are slow even on small
/// grids are drawn rarely.
SolverRequest draw_request(Random& random);

std::string describe(const SolverRequest& request);

}  // namespace bevloc::fuzz
