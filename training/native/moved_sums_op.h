// C interface to match_moved() (pipeline/solver/pose_scorer.h) for training: the sums that make up
// the ZNCC, for a batch of features [count, channels, 100, 50]. Used by training/moved_sums.py.
// Corrections are (x m, y m, yaw rad) within the range of the paper's hypotheses. `step` and `skew`
// define a CellLattice. All arrays are row-major and owned by the caller.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/// corrections: double [count, poses, 3]. sums: double [count, poses, 3], over the lattice's cells
/// and all channels: of map times moved features, of moved features and of their squares.
void bevloc_moved_sums(int count, int channels, int poses, int step, int skew, const float* bev,
                       const float* map, const double* corrections, double* sums);

/// Writes the gradients of sum(grad_sums * sums) with respect to both features.
void bevloc_moved_sums_gradients(int count, int channels, int poses, int step, int skew,
                                 const float* bev, const float* map, const double* corrections,
                                 const double* grad_sums, float* grad_bev, float* grad_map);

#ifdef __cplusplus
}
#endif
