// Interface of the methods that score hypotheses: one Matcher per method.
#pragma once

#include <span>

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/solver_result.h"

namespace bevloc {

/// The features of one side (BEV or map), in both forms. Owns nothing.
struct MatchSide {
  std::span<const float> raw;  ///< features from the network, [channels, rows, cols]
  const CellFeatures& cells;   ///< standardised (standardise.h)
};

/// Scores hypotheses. A matcher allocates its scratch memory in the constructor; match() allocates
/// nothing. One thread.
class Matcher {
 public:
  virtual ~Matcher() = default;

  /// Writes `result.correction` and the three distributions of `result`. The distributions must
  /// already have the lengths of the axes (resize_distributions()).
  virtual void match(const MatchSide& bev, const MatchSide& map, SolverResult& result) = 0;
};

}  // namespace bevloc
