// Iterative closest points: perceived lines onto the map's.
#pragma once

#include "firmware/evaluation/baselines/baseline.h"
#include "pipeline/solver/solver.h"

namespace bevloc::evaluation {

/// Starts at the prior pose. Each point in the middle of a perceived line takes the nearest line of
/// its class in the map that runs about as it does, if it is within a radius that shrinks from
/// iteration to iteration; the sum of robust squared distances to those lines is minimised.
class IterativeClosestPoints : public Baseline {
 public:
  explicit IterativeClosestPoints(const HypothesisGrid& ranges) : ranges_(ranges) {}

  Se2 correct(const BaselineInput& input) override;

 private:
  HypothesisGrid ranges_;
};

}  // namespace bevloc::evaluation
