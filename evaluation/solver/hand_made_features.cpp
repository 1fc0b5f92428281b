#include "evaluation/solver/hand_made_features.h"

#include <cassert>

#include "pipeline/solver/standardise.h"
#include "sim/perception/mask_features.h"

namespace bevloc::evaluation {
namespace {

template <typename Value>
std::vector<float> compute_features(std::span<const Value> mask, int channels) {
  std::vector<float> features(static_cast<size_t>(channels) * kFeatureGrid.cells());
  sim::MaskFeatures(channels, kFeatureGrid).compute(mask, features);
  return features;
}

}  // namespace

std::vector<float> features_of(std::span<const float> mask, int channels) {
  return compute_features(mask, channels);
}

std::vector<float> features_of(std::span<const uint8_t> raster, int channels) {
  return compute_features(raster, channels);
}

CellFeatures standardised_cells(std::span<const float> features, int channels,
                                const HypothesisGrid& hypotheses) {
  CellFeatures cells(kFeatureGrid, channels, hypotheses);
  cells.assign(features);
  [[maybe_unused]] const bool matchable = standardise(cells);
  assert(matchable);
  return cells;
}

}  // namespace bevloc::evaluation
