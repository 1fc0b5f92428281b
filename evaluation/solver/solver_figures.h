// The data of the figures in docs/solver.md, computed by the solver's own code. script/figures
// draws them.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.h"

namespace bevloc::evaluation {

/// The number of scenes to choose from. The evaluation has far more of each kind of road.
inline constexpr uint64_t kMostFigureScenes = 100'000;

/// Writes one JSON file with the data of the paper's Fig. 3, 4 and 5d:
///
///     scene          the number
///     spectra        spectra_figure.h
///     axis_features  axis_figure.h
///     distributions  distribution_figure.h
///
/// `scene` selects among the evaluation's scenes of each kind of road: 0 is the first of each.
/// Fails if the scene's town has no junction or the file cannot be written.
Status write_solver_figures(uint64_t scene, const std::string& file);

}  // namespace bevloc::evaluation
