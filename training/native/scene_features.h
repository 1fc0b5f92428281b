// C interface through which training reads the scenes on which pose solvers are judged without a
// network (sim/perception/matching_scene.h).
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/// Fills the first `count` of the tuning scenes, perceived as well as the paper's network does
/// (CorruptionLevel::kPaper):
///   bev         float [count, 16, 100, 50]  channels of the perceived mask (MaskFeatures)
///   map         float [count, 16, 100, 50]  the same of the map drawn at T0
///   correction  double [count, 3]           dT = T0^-1 T: x m, y m, yaw rad
/// dT is uniform in +-2 m, +-1 m, +-2 degrees. Always the same scenes.
void bevloc_scene_features(int count, float* bev, float* map, double* correction);

#ifdef __cplusplus
}
#endif
