// Hand-made features of masks and rasters, as input for solvers (the paper's input S).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "evaluation/solver/solver_case.h"
#include "sim/perception/mask_features.h"

namespace bevloc::evaluation {

/// The features of a mask and of a map's raster, with one grid and one number of channels.
class MaskInput {
 public:
  MaskInput(int channels, const BevGrid& grid);

  /// Whether a case has this grid and number of channels.
  bool serves(const SolverCase& solver_case) const;

  /// Computes the features of a mask (kRasterSize probabilities) and of the map at the prior pose
  /// (kRasterSize bytes).
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

/// The MaskInput of every size that the cases need. Cases of one size share theirs.
class MaskInputs {
 public:
  /// The input of a case; makes it if needed. It lives as long as this object.
  const MaskInput* of(const SolverCase& solver_case);
  void take(std::span<const float> perceived, std::span<const uint8_t> raster);
  bool empty() const { return inputs_.empty(); }

 private:
  std::vector<std::unique_ptr<MaskInput>> inputs_;
};

}  // namespace bevloc::evaluation
