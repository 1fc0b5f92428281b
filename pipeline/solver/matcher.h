// One way to find the correction under which two sides' features lie best on each other.
#pragma once

#include <span>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// The features of one side.
struct MatchSide {
  std::span<const float> raw;  ///< as the network gives them, [channels, rows, cols]
  const CellFeatures& cells;   ///< standardised (standardise.h)
};

/// Scratch memory is made in the constructor; match() allocates nothing. Not thread safe.
class Matcher {
 public:
  virtual ~Matcher() = default;

  /// Fills the three distributions of `result`, which have their lengths, and its correction.
  virtual void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) = 0;
};

}  // namespace bevloc
