// A baseline without a network: finds paint in the images and aligns it with the map.
#pragma once

#include "evaluation/baselines/baseline.h"
#include "evaluation/baselines/ground_view.h"
#include "evaluation/baselines/line_points.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc::evaluation {

/// The centre lines of everything that is brighter than the ground beside it and no wider than
/// paint. A top-hat filter finds them; its threshold follows the local brightness.
LinePoints paint_lines(const GroundImage& ground);

/// Projects the images onto the ground (inverse perspective mapping), finds paint, and aligns it
/// with the distance transform of the map's dividers and crossings. It does not use the network's
/// mask, and it assumes that all cameras expose at the same time.
class InversePerspectiveMapping : public Baseline {
 public:
  explicit InversePerspectiveMapping(const HypothesisGrid& ranges) : ranges_(ranges) {}

  Se2 correct(const BaselineInput& input) override;

 private:
  HypothesisGrid ranges_;
};

}  // namespace bevloc::evaluation
