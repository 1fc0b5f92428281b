// A baseline that aligns perceived lines with the map by iterative closest points.
#pragma once

#include "evaluation/baselines/baseline.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc::evaluation {

/// Starts at the prior pose. Each iteration assigns to every perceived point the nearest point of
/// its class in the map, if it is within a radius and its line runs in about the same direction. It
/// then minimises the robust squared distances to these lines. The radius shrinks with each
/// iteration.
class IterativeClosestPoints : public Baseline {
 public:
  explicit IterativeClosestPoints(const HypothesisGrid& ranges) : ranges_(ranges) {}

  Se2 correct(const BaselineInput& input) override;

 private:
  HypothesisGrid ranges_;
};

}  // namespace bevloc::evaluation
