// The pictures of docs/solver.md, drawn by the solver's own code.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.h"

namespace bevloc::evaluation {

/// Far fewer than the evaluation has of each kind of road.
inline constexpr uint64_t kMostFigureScenes = 100'000;

/// Writes solver_spectra.png, solver_axis_features.png and solver_distributions.png (the paper's
/// Fig. 3, 4 and 5d) into a folder, which is made if it is not there. `scene` chooses among the
/// evaluation's scenes of each kind of road: 0 is the first of each. Fails where the folder cannot
/// be written.
Status draw_solver_figures(uint64_t scene, const std::string& folder);

}  // namespace bevloc::evaluation
