// Features as every solver reads them: each channel with mean 0 and (nearly) unit deviation.
#pragma once

#include "pipeline/solver/cell_features.h"

namespace bevloc {

/// Makes each channel (f - mean) / (std + 0.01), population moments over all cells. False, and the
/// features are not to be used, where there is nothing to match: a value is not finite, or every
/// channel is constant.
bool standardise(CellFeatures& features);

}  // namespace bevloc
