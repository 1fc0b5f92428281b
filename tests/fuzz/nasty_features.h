// Features of every sort that a broken camera, network or map could make.
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
  kConstant,  ///< each channel one value, of any size
  kDenormal,
  kNan,  ///< one among good ones
  kInfinity,
  kTinyNoise,  ///< on a constant
  kHotCell,
  kHuge,      ///< +-3e38 at random
  kHugeCell,  ///< 3e38 in the midst of -3e38
  kAlternating,
  kDeadChannels,  ///< some are constant
  kMask,          ///< saturated blocks of 0 and 1
  kStripes,       ///< along one axis
  kNoise,
  kBumps,
};

std::string_view name_of(FeatureSort sort);
/// Nothing to match in them, or certainly something; else it depends.
bool has_no_structure(FeatureSort sort);
bool has_structure(FeatureSort sort);

/// Both sides of a match; kBumps on both sides show the same bumps, seen from two poses.
struct FeaturePair {
  FeatureSort bev_sort{};
  FeatureSort map_sort{};
  std::vector<float> bev;
  std::vector<float> map;
};

FeaturePair draw_features(Random& random, const SolverRequest& request);

}  // namespace bevloc::fuzz
