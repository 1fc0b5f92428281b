// Paint found without a network, on the ground seen from above.
#pragma once

#include "firmware/evaluation/baselines/baseline.h"
#include "firmware/evaluation/baselines/ground_view.h"
#include "firmware/evaluation/baselines/line_points.h"
#include "pipeline/solver/solver.h"

namespace bevloc::evaluation {

/// The middles of what is brighter than the ground to either side of it and no wider than paint: a
/// top hat, against a threshold that follows the local brightness.
LinePoints paint_lines(const GroundPicture& picture);

/// Maps the images onto the ground by the calibration (inverse perspective mapping), finds paint in
/// it, and lays it onto the distance transform of the map's dividers and crossings together. Reads
/// no perceived mask. Takes all images as of one time.
class InversePerspectiveMapping : public Baseline {
 public:
  /// `network_rig` is that of the images.
  InversePerspectiveMapping(const Rig& network_rig, const HypothesisGrid& ranges)
      : ground_view_(network_rig), ranges_(ranges) {}

  Se2 correct(const BaselineInput& input) override;

 private:
  GroundView ground_view_;
  HypothesisGrid ranges_;
};

}  // namespace bevloc::evaluation
