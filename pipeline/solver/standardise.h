// Standardises features: each channel gets mean 0 and nearly unit standard deviation.
#pragma once

#include "pipeline/solver/cell_features.h"

namespace bevloc {

/// Replaces each channel by (f - mean) / (std + 0.01), with the population moments over all cells.
/// Returns false if there is nothing to match, because a value is not finite or every channel is
/// constant. The features must not be used then.
bool standardise(CellFeatures& features);

}  // namespace bevloc
