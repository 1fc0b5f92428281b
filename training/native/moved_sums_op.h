// C interface through which training moves features and matches them (training/moved_sums.py), over
// a batch of features [count, channels, 100, 50]. Corrections are (x m, y m, yaw rad) and lie
// within the paper's hypotheses; `step` and `skew` are those of a CellLattice.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/// corrections: double [count, poses, 3]. sums: double [count, poses, 3], over the lattice's cells
/// and all channels, of map times moved features, of moved features, and of their squares.
void bevloc_moved_sums(int count, int channels, int poses, int step, int skew, const float* bev,
                       const float* map, const double* corrections, double* sums);

/// Gradients of sum(grad_sums * sums) with respect to both features.
void bevloc_moved_sums_gradients(int count, int channels, int poses, int step, int skew,
                                 const float* bev, const float* map, const double* corrections,
                                 const double* grad_sums, float* grad_bev, float* grad_map);

#ifdef __cplusplus
}
#endif
