#include "evaluation/solver/mask_input.h"

#include <algorithm>

namespace bevloc::evaluation {

MaskInput::MaskInput(int channels, const BevGrid& grid)
    : channels_(channels),
      grid_(grid),
      maker_(channels, grid),
      bev_(static_cast<size_t>(channels) * grid.cells()),
      map_(bev_.size()) {}

bool MaskInput::serves(const SolverCase& solver_case) const {
  return solver_case.channels == channels_ && solver_case.grid.rows == grid_.rows;
}

void MaskInput::take(std::span<const float> perceived, std::span<const uint8_t> raster) {
  maker_.compute(perceived, bev_);
  maker_.compute(raster, map_);
}

const MaskInput* MaskInputs::of(const SolverCase& solver_case) {
  const auto found =
      std::ranges::find_if(inputs_, [&](const auto& input) { return input->serves(solver_case); });
  if (found != inputs_.end()) return found->get();
  return inputs_.emplace_back(std::make_unique<MaskInput>(solver_case.channels, solver_case.grid))
      .get();
}

void MaskInputs::take(std::span<const float> perceived, std::span<const uint8_t> raster) {
  for (const auto& input : inputs_) input->take(perceived, raster);
}

}  // namespace bevloc::evaluation
