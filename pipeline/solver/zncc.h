// Zero-mean normalised cross-correlation (ZNCC), from sums over cells and channels.
#pragma once

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/cell_lattice.h"

namespace bevloc {

struct FeatureMoments {
  double mean = 0.0;
  double deviation = 0.0;  ///< standard deviation of the population
};

/// Moments from the sums of `count` values and of their squares.
FeatureMoments moments(double sum, double square_sum, double count);

/// Moments over the cells of the lattice and all channels.
FeatureMoments moments_of(const CellFeatures& features, const CellLattice& lattice = kEveryCell);

/// ZNCC of two sides (paper, eq. 5) from the sum of their products over `count` values. It is 0 if
/// a side is constant.
double zncc(double product_sum, const FeatureMoments& a, const FeatureMoments& b, double count);

}  // namespace bevloc
