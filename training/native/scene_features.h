// C interface to the scenes on which solvers are evaluated without a network
// (sim/perception/matching_scene.h). Used by training/ablation.py.
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/// Writes the first `count` tuning scenes. Their masks are as good as those of the paper's network
/// (CorruptionLevel::kPaper). The scenes are the same in every call.
///   bev         float [count, 16, 100, 50]  channels of the perceived mask (MaskFeatures)
///   map         float [count, 16, 100, 50]  channels of the map drawn at T0
///   correction  double [count, 3]           dT = T0^-1 T: x m, y m, yaw rad
/// dT is uniform in +-2 m, +-1 m, +-2 degrees.
void bevloc_scene_features(int count, float* bev, float* map, double* correction);

#ifdef __cplusplus
}
#endif
