// The data of the paper's Fig. 3: amplitude spectra, and the yaw scores that follow from them.
#pragma once

#include <cstdint>

#include <nlohmann/json_fwd.hpp>

#include "common/result.h"

namespace bevloc::evaluation {

/// A junction's map from three poses: as it is, rotated by `turn_deg`, and also moved by `shift_m`
/// along x and y.
///
///     turn_deg, shift_m
///     band                   the band whose signature is given
///     band_edges_per_m       nine frequencies
///     frequency_limit_per_m  the spectrum covers -limit to +limit along both axes
///     angles_deg             of the signature
///     hypotheses_deg         of the score
///     views                  three times {raster: [channel][row][column] 0 to 255,
///                            log_amplitude: [row][column], signature, score}
///
/// log_amplitude is log(1 + amplitude) with frequency 0 at the centre and forward up; signature and
/// score are those of YawSpectrum, the score against the first view. `town` selects one of the
/// evaluation's towns. Fails if no junction is found there.
Result<nlohmann::json> spectra_figure(uint64_t town);

}  // namespace bevloc::evaluation
