// C interface through which training scores hypotheses: pipeline/solver/joint_volume.h over a batch
// of features [count, channels, 100, 50], on the paper's hypotheses.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/// volume: float [count, 21 yaw, 21 x, 11 y].
void bevloc_joint_volume(int count, int channels, int block_cells, const float* bev,
                         const float* map, float* volume);

/// Gradients of sum(grad_volume * volume) with respect to both features.
void bevloc_joint_volume_gradients(int count, int channels, int block_cells, const float* bev,
                                   const float* map, const float* grad_volume, float* grad_bev,
                                   float* grad_map);

#ifdef __cplusplus
}
#endif
