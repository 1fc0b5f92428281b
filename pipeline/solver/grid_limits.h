// Limits of the grids that solvers accept, and the error message for other grids.
#pragma once

#include <string_view>

#include "common/result.h"
#include "pipeline/bev_grid.h"

namespace bevloc {

/// Most rows and columns of a grid. Larger grids are typing errors.
inline constexpr int kMaxGridSide = 1024;

/// The error "solver: found a grid of ..., wanted `wanted`".
inline tl::unexpected<Error> refuse_grid(const BevGrid& grid, std::string_view wanted) {
  return fail("solver: found a grid of {} x {} cells of {} m, wanted {}", grid.rows, grid.cols,
              grid.cell_m, wanted);
}

}  // namespace bevloc
