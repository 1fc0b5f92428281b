// Solves the golden scenes (training/golden_solver.py).
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/solver/solver.h"
#include "tests/support/npy.h"

namespace bevloc::test {

/// What `solver` answers to sample i of features [samples, channels, rows, cols].
inline SolverResult solve_sample(Solver& solver, const NpyArray<float>& bev,
                                 const NpyArray<float>& map, size_t i) {
  const int channels = static_cast<int>(bev.shape.at(1));
  const std::vector<float> bev_data = bev.entry(i);
  const std::vector<float> map_data = map.entry(i);
  SolverResult result;
  solver.solve({bev_data, channels, kFeatureGrid}, {map_data, channels, kFeatureGrid}, result);
  return result;
}

/// The distributions along x, y and yaw, one after the other.
inline std::vector<float> distributions(const SolverResult& result) {
  std::vector<float> all = result.x_probability;
  all.insert(all.end(), result.y_probability.begin(), result.y_probability.end());
  all.insert(all.end(), result.yaw_probability.begin(), result.yaw_probability.end());
  return all;
}

}  // namespace bevloc::test
