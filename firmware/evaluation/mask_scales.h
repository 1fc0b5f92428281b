// The softmax scales of solvers that read masks: training learned those of features alone.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "common/result.h"
#include "common/se2.h"
#include "firmware/evaluation/mask_input.h"
#include "firmware/evaluation/solver_score.h"

namespace bevloc::evaluation {

/// A frame that no evaluation looks at. A mask that no solver reads is empty.
struct TuningFrame {
  std::vector<float> perceived;  ///< by a network, kRasterSize probabilities
  std::vector<float> truth;      ///< what a network without errors would perceive
  std::vector<uint8_t> raster;   ///< the map at the prior pose
  Se2 correction;                ///< dT = T0^-1 T
};

class MaskScales {
 public:
  using Mask = std::vector<float> TuningFrame::*;

  /// Of solvers that read this mask of the frames, which must outlive it.
  MaskScales(const std::vector<TuningFrame>& frames, Mask mask) : frames_(frames), mask_(mask) {}

  /// The scales with the least negative log-likelihood on the frames, found with steps of 0.2 for
  /// all steps. Found once for each solver and size. Fails as make_solver() does.
  Result<SolverParameters> parameters_for(SolverCase solver_case);

 private:
  Result<SolverParameters> tune(const SolverCase& solver_case);
  Result<std::vector<PerAxis>> likelihoods(const SolverCase& solver_case,
                                           const std::vector<SolverParameters>& candidates) const;

  const std::vector<TuningFrame>& frames_;
  const Mask mask_;
  std::vector<std::pair<SolverCase, SolverParameters>> found_;
};

}  // namespace bevloc::evaluation
