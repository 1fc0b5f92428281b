// Features as every solver reads them: each channel with mean 0 and (nearly) unit deviation.
#pragma once

#include <span>

#include "pipeline/solver/solver.h"

namespace bevloc {

/// Writes (f - mean) / (std + 0.01) of each channel, population moments over all cells, in the
/// layout of `features`. False, and `standardised` is not to be used, where there is nothing to
/// match: the size is not channels * cells, a value is not finite, or every channel is constant.
bool standardise(const FeatureView& features, std::span<float> standardised);

}  // namespace bevloc
