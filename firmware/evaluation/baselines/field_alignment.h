// Lays points onto distance fields.
#pragma once

#include <span>

#include "common/se2.h"
#include "firmware/evaluation/baselines/distance_field.h"
#include "pipeline/solver/solver.h"

namespace bevloc::evaluation {

/// Points, and how far each place is from the lines they should lie on.
struct PointsOnField {
  LinePoints points;
  DistanceField field;
};

/// The correction within the ranges under which the points lie best: the least sum of truncated
/// squared distances (Geman and McClure's), with the prior's. A coarse grid over the ranges gives
/// the starts, Levenberg and Marquardt's method does the rest. Pairs without lines have no say.
Se2 align(std::span<const PointsOnField> pairs, const HypothesisGrid& ranges);

}  // namespace bevloc::evaluation
