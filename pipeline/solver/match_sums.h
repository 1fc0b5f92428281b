// The sums from which the ZNCC of moved BEV features with map features is computed.
#pragma once

#include "pipeline/solver/lanes.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// Sums over cells, separately for kLanes channels.
struct LaneSums {
  Lanes product = {};  ///< map feature times moved feature
  Lanes value = {};    ///< moved feature
  Lanes square = {};   ///< moved feature squared

  void add(const Lanes& map, const Lanes& moved) {
    product += map * moved;
    value += moved;
    square += moved * moved;
  }
};

/// The same sums over all channels.
struct MatchSums {
  double product = 0.0;
  double value = 0.0;
  double square = 0.0;

  MatchSums& operator+=(const MatchSums& other) {
    product += other.product;
    value += other.value;
    square += other.square;
    return *this;
  }
};

/// Adds two partial sums and all their lanes.
inline MatchSums sum_of(const LaneSums& a, const LaneSums& b) {
  return {sum_of(a.product + b.product), sum_of(a.value + b.value), sum_of(a.square + b.square)};
}

/// ZNCC from sums over `count` values and the moments of the map.
inline double zncc(const MatchSums& sums, const FeatureMoments& map, double count) {
  return zncc(sums.product, map, moments(sums.value, sums.square, count), count);
}

}  // namespace bevloc
