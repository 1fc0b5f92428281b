// A view of the features of one side: BEV (from the images) or map.
#pragma once

#include <span>

#include "pipeline/bev_grid.h"

namespace bevloc {

/// Features [channels, rows, cols] on `grid`. The view does not own `data`.
struct FeatureView {
  std::span<const float> data;
  int channels = 0;
  BevGrid grid;
};

}  // namespace bevloc
