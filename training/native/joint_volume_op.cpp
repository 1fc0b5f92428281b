#include "training/native/joint_volume_op.h"

#include "pipeline/solver/reference/joint_volume.h"

namespace {

bevloc::JointVolume make_volume(int channels, int block_cells) {
  return {bevloc::HypothesisGrid{}, bevloc::kFeatureGrid, channels, block_cells};
}

}  // namespace

void bevloc_joint_volume(int count, int channels, int block_cells, const float* bev,
                         const float* map, float* volume) {
  bevloc::JointVolume joint = make_volume(channels, block_cells);
  const size_t features = joint.feature_count();
  const size_t hypotheses = joint.hypothesis_count();
  for (int i = 0; i < count; ++i) {
    joint.scores({bev + i * features, features}, {map + i * features, features},
                 {volume + i * hypotheses, hypotheses});
  }
}

void bevloc_joint_volume_gradients(int count, int channels, int block_cells, const float* bev,
                                   const float* map, const float* grad_volume, float* grad_bev,
                                   float* grad_map) {
  bevloc::JointVolume joint = make_volume(channels, block_cells);
  const size_t features = joint.feature_count();
  const size_t hypotheses = joint.hypothesis_count();
  for (int i = 0; i < count; ++i) {
    joint.gradients({bev + i * features, features}, {map + i * features, features},
                    {grad_volume + i * hypotheses, hypotheses}, {grad_bev + i * features, features},
                    {grad_map + i * features, features});
  }
}
