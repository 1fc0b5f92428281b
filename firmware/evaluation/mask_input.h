// Hand-made features of masks, as solvers read them (the paper's input S).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "firmware/evaluation/solver_case.h"
#include "sim/perception/mask_features.h"

namespace bevloc::evaluation {

/// The features of a perceived mask and of a map's raster, in one size.
class MaskInput {
 public:
  MaskInput(int channels, const BevGrid& grid);

  bool serves(const SolverCase& solver_case) const;
  /// kRasterSize probabilities, and the map at the prior pose, kRasterSize bytes.
  void take(std::span<const float> perceived, std::span<const uint8_t> raster);

  FeatureView bev() const { return {bev_, channels_, grid_}; }
  FeatureView map() const { return {map_, channels_, grid_}; }

 private:
  int channels_;
  BevGrid grid_;
  sim::MaskFeatures maker_;
  std::vector<float> bev_;
  std::vector<float> map_;
};

/// Those of all sizes that are needed: solvers of one size share theirs.
class MaskInputs {
 public:
  /// It stays where it is as long as this does.
  const MaskInput* of(const SolverCase& solver_case);
  void take(std::span<const float> perceived, std::span<const uint8_t> raster);
  bool empty() const { return inputs_.empty(); }

 private:
  std::vector<std::unique_ptr<MaskInput>> inputs_;
};

}  // namespace bevloc::evaluation
