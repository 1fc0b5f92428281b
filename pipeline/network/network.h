// The localization network (paper, III-B and III-C): cameras and map raster in, matchable features
// out.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "common/result.h"
#include "pipeline/network/engine.h"
#include "pipeline/network/turn.h"
#include "pipeline/network/view_table.h"
#include "pipeline/solver/solver.h"

namespace bevloc {

/// Channels of the features that the solver matches.
inline constexpr int kFeatureChannels = 16;

struct NetworkOptions {
  int threads = 1;
  IsaCap isa = IsaCap::kBest;
  /// What runs it; CMake's BEVLOC_ENGINE says which one that is by default.
  nn::MakeEngine* engine = nn::make_default_engine;
};

/// A model file is standard ONNX with these ports:
///   images        int8 [6, 3, 96, 320]: RGB planes minus 128, ordered as kCameraNames
///   view_index    int32 or int64 [8, 5000], of a ViewTable
///   view_weight   float [8, 5000]
///   raster        uint8 [3, 400, 200] or [1, 3, 400, 200], as MapRasterizer draws it
///   bev_features  float [1, 16, 100, 50]
///   map_features  float [1, 16, 100, 50]
///   bev_mask      float [1, 3, 400, 200]
///
/// int8 where it holds QuantizeLinear and DequantizeLinear (zero points 0, weights per channel),
/// float elsewhere. Its metadata hold bevloc.solver.{joint_scale, x_scale, y_scale, yaw_scale,
/// gem_omega}, and may hold {refine,banded}_..._scale (else joint_scale) and sigma_scale (else 1).
///
/// All buffers are made at load; nothing allocates, throws or locks afterwards, but for what
/// make_onednn_engine() and make_xnnpack_engine() say of their libraries. Not thread safe.
class Network {
 public:
  /// Errors: the file is missing, damaged, not the network described above, or uses an operator
  /// that the executor does not know (it is named).
  static Result<std::unique_ptr<Network>> load(const std::string& path,
                                               const NetworkOptions& options);
  ~Network();

  /// Until the first call no camera sees anything. Copies the table.
  void set_view_table(const ViewTable& table);

  /// Inputs, to be written before a run; they keep their content.
  std::span<int8_t> image_input();
  std::span<uint8_t> raster_input();

  /// The three parts: the images' features, the map's, and, after the images', the mask perceived.
  void run_image_branch();
  void run_map_branch();
  void run_mask_head();

  /// Other work on the network's threads: turn(i) for i from 0 up to `count`, in any order, in the
  /// caller's where there is one. It must not throw.
  void for_each_turn(int count, Turn turn);

  /// [16, 100, 50] on kFeatureGrid; valid until the branch runs again.
  FeatureView bev_features() const;
  FeatureView map_features() const;
  /// [3, 400, 200] on kRasterGrid, logits.
  std::span<const float> mask_logits() const;

  const SolverParameters& solver_parameters() const;
  const std::string& name() const;

 private:
  struct State;
  explicit Network(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace bevloc
