// The steps from images to CAN frames, so that each can be timed on its own.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/bench/cost_model.h"
#include "evaluation/bench/scene.h"
#include "pipeline/map/map_index.h"
#include "pipeline/network/model/network_cost.h"

namespace bevloc::bench {

/// All stages, in the order in which they must run.
inline constexpr std::array<std::string_view, 19> kStageNames{
    "frameset", "images-rgb24", "network-images", "map-raster", "network-map", "solver",
    "map-check", "tracker", "can",
    // Not part of a frame:
    "mjpeg-decode", "images-yuyv", "images-uyvy", "images-nv12", "images-bayer_rggb",
    "images-mjpeg", "view-table", "map-crop", "network-mask", "solver-acquiring"};

struct Stage {
  std::string name;
  bool in_frame = false;  ///< part of every frame in the steady state
  Work work;
  std::function<void()> run;
};

/// The stages, built from the pipeline's classes with their own buffers. The stages of a frame, run
/// in order, do the daemon's work for one frameset. One thread.
class Stages {
 public:
  /// `config`, `scene` and `index` must outlive the stages. Fails as Network::load() and
  /// make_solver() do.
  static Result<std::unique_ptr<Stages>> create(const firmware::Config& config, const Scene& scene,
                                                const MapIndex& index, int threads);
  ~Stages();

  /// All stages in the order of kStageNames.
  const std::vector<Stage>& all() const { return stages_; }

  /// Moves the vehicle to a place and restarts tracker and synchronizer.
  void go_to(const Place& place);

  /// Prepares the next frame: its images, and the vehicle's samples up to its exposure. Call it
  /// before the stages run; it is not timed. `images` must live until the next call.
  void begin_frame(const FramesetImages& images);

 private:
  struct Parts;
  explicit Stages(std::unique_ptr<Parts> parts);
  void add_stages_of_the_frame(const NetworkCost& cost);
  void add_other_stages(const NetworkCost& cost);
  void add(std::string name, bool in_frame, const Work& work, std::function<void(Parts&)> run);

  std::unique_ptr<Parts> parts_;
  std::vector<Stage> stages_;
};

}  // namespace bevloc::bench
