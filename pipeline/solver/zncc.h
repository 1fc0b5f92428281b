// Zero-mean normalised cross-correlation, from sums over all cells and channels.
#pragma once

#include "pipeline/solver/cell_features.h"
#include "pipeline/solver/cell_lattice.h"

namespace bevloc {

struct FeatureMoments {
  double mean = 0.0;
  double deviation = 0.0;
};

/// From sums over `count` values. The deviation is of the population.
FeatureMoments moments(double sum, double square_sum, double count);

/// Over the lattice's cells and all channels.
FeatureMoments moments_of(const CellFeatures& features, const CellLattice& lattice = kEveryCell);

/// Zero-mean normalised cross-correlation (paper, eq. 5) from the sum of products of two sides
/// over `count` values; 0 where a side is constant.
double zncc(double product_sum, const FeatureMoments& a, const FeatureMoments& b, double count);

}  // namespace bevloc
