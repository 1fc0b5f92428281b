// A baseline that aligns perceived lines with the distance transform of the map.
#pragma once

#include "evaluation/baselines/baseline.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc::evaluation {

/// Minimises a robust cost: the distances of perceived points to the map's lines of their class,
/// read from distance transforms. It starts from several corrections within the ranges. The method
/// follows L. Zhao et al., "Towards Robust Visual Localization Using Multi-View Images and HD
/// Vector Map" (the paper's [27]); the code is our own.
class DistanceTransformAlignment : public Baseline {
 public:
  explicit DistanceTransformAlignment(const HypothesisGrid& ranges) : ranges_(ranges) {}

  Se2 correct(const BaselineInput& input) override;

 private:
  HypothesisGrid ranges_;
};

}  // namespace bevloc::evaluation
