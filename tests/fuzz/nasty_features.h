// Draws features of every sort that a broken camera, network or map could produce.
#pragma once

#include <string_view>
#include <vector>

#include "tests/fuzz/solver_request.h"

namespace bevloc::fuzz {

enum class FeatureSort {
  kNothing,  ///< no data at all
  kTooShort,
  kTooLong,
  kZero,
  kConstant,  ///< one value per channel, of any magnitude
  kDenormal,
  kNan,           ///< one NaN in noise
  kInfinity,      ///< one infinity in noise
  kTinyNoise,     ///< on a constant
  kHotCell,       ///< zero except for one cell
  kHuge,          ///< random signs of 3e38
  kHugeCell,      ///< one cell of 3e38, all others -3e38
  kAlternating,   ///< a chessboard of 1 and -1
  kDeadChannels,  ///< all channels constant except the first
  kMask,          ///< a block of 1, the rest 0
  kStripes,       ///< along one axis
  kNoise,
  kBumps,
};

std::string_view name_of(FeatureSort sort);
/// Whether such features never have structure that a solver could match.
bool has_no_structure(FeatureSort sort);
/// Whether such features always have structure. Some sorts have it only sometimes.
bool has_structure(FeatureSort sort);

/// The features of both sides. If both are kBumps, they show the same bumps from two poses.
struct FeaturePair {
  FeatureSort bev_sort{};
  FeatureSort map_sort{};
  std::vector<float> bev;
  std::vector<float> map;
};

FeaturePair draw_features(Random& random, const SolverRequest& request);

}  // namespace bevloc::fuzz
