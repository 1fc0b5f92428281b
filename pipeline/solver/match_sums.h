// What a ZNCC of moved vehicle features with map features is made of.
#pragma once

#include "pipeline/solver/lanes.h"
#include "pipeline/solver/zncc.h"

namespace bevloc {

/// Sums over cells, for sixteen channels side by side.
struct LaneSums {
  Lanes product = {};  ///< of map and moved feature
  Lanes value = {};    ///< of moved features
  Lanes square = {};

  void add(const Lanes& map, const Lanes& moved) {
    product += map * moved;
    value += moved;
    square += moved * moved;
  }
};

/// The same over all channels.
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

/// Of two that were kept side by side, to hide the latency of the additions.
inline MatchSums sum_of(const LaneSums& a, const LaneSums& b) {
  return {sum_of(a.product + b.product), sum_of(a.value + b.value), sum_of(a.square + b.square)};
}

/// From sums over `count` values.
inline double zncc(const MatchSums& sums, const FeatureMoments& map, double count) {
  return zncc(sums.product, map, moments(sums.value, sums.square, count), count);
}

}  // namespace bevloc
