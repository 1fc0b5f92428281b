// Finds softmax scales for solvers that match masks. The scales in a model file are for the
// network's features.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "common/result.h"
#include "common/se2.h"
#include "evaluation/solver/mask_input.h"
#include "evaluation/solver/solver_score.h"

namespace bevloc::evaluation {

/// A sample that no evaluation uses. Masks that no solver matches are empty.
struct TuningSample {
  std::vector<float> perceived;  ///< the network's mask, kRasterSize probabilities
  std::vector<float> truth;      ///< the mask of a network without errors
  std::vector<uint8_t> raster;   ///< the map at the prior pose
  Se2 correction;                ///< dT = T0^-1 T
};

/// Tunes each solver once, on the same samples. One thread.
class MaskScales {
 public:
  using Mask = std::vector<float> TuningSample::*;

  /// Tunes solvers that match `mask` of each sample. `samples` must outlive this object.
  MaskScales(const std::vector<TuningSample>& samples, Mask mask)
      : samples_(samples), mask_(mask) {}

  /// The scales with the lowest negative log-likelihood on the samples. Hypotheses have steps of
  /// 0.2 whatever the case's step is, and each solver and size is tuned only once. Fails as
  /// make_solver() does.
  Result<SolverParameters> parameters_for(SolverCase solver_case);

 private:
  Result<SolverParameters> tune(const SolverCase& solver_case);
  Result<std::vector<PerAxis>> likelihoods(const SolverCase& solver_case,
                                           const std::vector<SolverParameters>& candidates) const;

  const std::vector<TuningSample>& samples_;
  const Mask mask_;
  std::vector<std::pair<SolverCase, SolverParameters>> found_;
};

}  // namespace bevloc::evaluation
