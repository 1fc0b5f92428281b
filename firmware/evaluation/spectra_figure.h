// What the yaw solver reads: a picture as the paper's Fig. 3.
#pragma once

#include <string>

#include "common/result.h"

namespace bevloc::evaluation {

/// A junction's map, the same turned by 10 degrees, and turned and moved by 5 m along both axes;
/// beside each its amplitude spectrum with the bands of YawSpectrum; below, the signature of one
/// band and the scores of the yaw hypotheses. `town` chooses the place among the evaluation's
/// towns.
Status draw_spectra(uint64_t town, const std::string& path);

}  // namespace bevloc::evaluation
