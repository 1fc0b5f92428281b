// Perceived lines onto the map's distance transform.
#pragma once

#include "firmware/evaluation/baselines/baseline.h"
#include "pipeline/solver/solver.h"

namespace bevloc::evaluation {

/// Optimises a robust cost of the points of perceived lines in the distance transforms of the map's
/// lines, class by class, from several starts over the ranges; in the manner of L. Zhao et al.,
/// "Towards Robust Visual Localization Using Multi-View Images and HD Vector Map" (the paper's
/// [27]), though not their code.
class DistanceTransformAlignment : public Baseline {
 public:
  explicit DistanceTransformAlignment(const HypothesisGrid& ranges) : ranges_(ranges) {}

  Se2 correct(const BaselineInput& input) override;

 private:
  HypothesisGrid ranges_;
};

}  // namespace bevloc::evaluation
