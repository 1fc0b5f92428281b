// Aligns points with distance fields.
#pragma once

#include <span>

#include "common/se2.h"
#include "evaluation/baselines/distance_field.h"
#include "pipeline/solver/hypotheses.h"

namespace bevloc::evaluation {

/// Points, and the distance field of the lines that they should lie on.
struct PointsOnField {
  LinePoints points;
  DistanceField field;
};

/// The correction within the ranges with the lowest cost: Geman and McClure's robust loss of the
/// distances, plus prior_cost(). The best corrections of a coarse grid are the starts of
/// Levenberg-Marquardt. Pairs without lines are ignored.
Se2 align(std::span<const PointsOnField> pairs, const HypothesisGrid& ranges);

}  // namespace bevloc::evaluation
