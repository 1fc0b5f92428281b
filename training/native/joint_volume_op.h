// C interface to the joint volume (pipeline/solver/reference/joint_volume.h) for training: scores
// the paper's hypotheses for a batch of standardised features [count, channels, 100, 50]. Used by
// training/joint_volume.py. All arrays are row-major and owned by the caller.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/// Writes the scores of all hypotheses. volume: float [count, 21 yaw, 21 x, 11 y]; `block_cells`:
/// cells of a block's side.
void bevloc_joint_volume(int count, int channels, int block_cells, const float* bev,
                         const float* map, float* volume);

/// Writes the gradients of sum(grad_volume * volume) with respect to both features.
void bevloc_joint_volume_gradients(int count, int channels, int block_cells, const float* bev,
                                   const float* map, const float* grad_volume, float* grad_bev,
                                   float* grad_map);

#ifdef __cplusplus
}
#endif
