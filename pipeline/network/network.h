// The localization network (paper, III-B and III-C): computes features that the solver can match,
// from the camera images and from the map raster.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/result.h"
#include "pipeline/network/engine/engine.h"
#include "pipeline/network/engine/loop_body.h"
#include "pipeline/network/model/model_rig.h"
#include "pipeline/network/view/view_table.h"
#include "pipeline/solver/feature_view.h"
#include "pipeline/solver/solver_parameters.h"

namespace bevloc {

/// Number of channels of the features that the solver matches.
inline constexpr int kFeatureChannels = 16;

using NetworkOptions = nn::EngineOptions;

/// A network, loaded from a standard ONNX file with these ports:
///   images        int8 [6, 3, 96, 320]: RGB planes minus 128, in the order of kCameraNames
///   view_index    int32 or int64 [8, 5000], from a ViewTable
///   view_weight   float [8, 5000], from a ViewTable
///   raster        uint8 [3, 400, 200] or [1, 3, 400, 200], as MapRasterizer draws it
///   bev_features  float [1, 16, 100, 50]
///   map_features  float [1, 16, 100, 50]
///   bev_mask      float [1, 3, 400, 200]
///
/// Computes in int8 where the file has QuantizeLinear and DequantizeLinear (with zero points 0 and
/// weight scales per channel), and in float elsewhere. The metadata must contain
/// bevloc.solver.{joint_scale, x_scale, y_scale, yaw_scale, gem_omega}. These are optional:
/// bevloc.solver.{refine,banded}_..._scale (default: joint_scale),
/// bevloc.solver.{sigma,score}_scale (default: 1), bevloc.rig.* (model_rig.h) and
/// bevloc.test_frame_answer (test_frame.h).
///
/// load() allocates all buffers. The other functions do not allocate, throw or lock, except for
/// what nn::Engine documents about oneDNN. One thread.
class Network {
 public:
  /// Fails if the file is missing, damaged or not the network described above, or if it uses an
  /// operator that the engine does not support (the message names it).
  static Result<std::unique_ptr<Network>> load(const std::string& path,
                                               const NetworkOptions& options);
  ~Network();

  /// Copies the table. Before the first call, the network sees nothing in the images.
  void set_view_table(const ViewTable& table);

  /// The inputs. Write them before a run; they keep their content.
  std::span<int8_t> image_input();
  std::span<uint8_t> raster_input();

  /// The three branches. The mask head reads results of the image branch, so it must run after it.
  void run_image_branch();
  void run_map_branch();
  void run_mask_head();

  /// Runs other work on the threads of the network: calls body(i) for each i in [0, count), in any
  /// order. With one thread, all calls happen in the caller's thread. `body` must not throw.
  void parallel_for(int count, LoopBody body);

  /// Features [16, 100, 50] on kFeatureGrid, valid until their branch runs again.
  FeatureView bev_features() const;
  FeatureView map_features() const;
  /// Logits [3, 400, 200] on kRasterGrid, valid until the mask head runs again.
  std::span<const float> mask_logits() const;

  const SolverParameters& solver_parameters() const;
  /// What the model states about its cameras; check_rig_fits() compares a rig with it.
  const ModelRig& rig() const;
  const std::string& name() const;
  /// The model's metadata of kAnswerKey (test_frame.h); empty if it has none.
  const std::string& stored_answer() const;

 private:
  struct State;
  explicit Network(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace bevloc
