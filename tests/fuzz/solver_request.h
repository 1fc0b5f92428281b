// What the fuzz program asks of make_solver(): anything that is allowed, and much that is not.
#pragma once

#include <random>
#include <string>

#include "pipeline/solver/solver_factory.h"

namespace bevloc::fuzz {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}
/// `low` and `high` are included.
inline int integer(Random& random, int low, int high) {
  return std::uniform_int_distribution(low, high)(random);
}
/// Uniform in the logarithm.
double log_uniform(Random& random, double low, double high);

enum class Acceptance { kMust, kMay, kMustNot };

struct SolverRequest {
  SolverKind kind{};
  BevGrid grid;
  int channels = 0;
  HypothesisGrid hypotheses;
  SolverParameters parameters;
  Acceptance acceptance = Acceptance::kMust;
  std::string culprit;  ///< what a refusal must name; empty where nothing is wrong
};

/// Small, so that a million solves are cheap; the kinds that are slow even then are drawn rarely.
SolverRequest draw_request(Random& random);

std::string describe(const SolverRequest& request);

}  // namespace bevloc::fuzz
