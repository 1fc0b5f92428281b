// The parts of the way from pictures to CAN frames, each to be run and timed by itself.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/bench/cost_model.h"
#include "firmware/bench/scene.h"
#include "pipeline/map/map_index.h"
#include "pipeline/network/network_cost.h"

namespace bevloc::bench {

/// All stages in the order in which they are to be run.
inline constexpr std::array<std::string_view, 19> kStageNames{
    "frameset", "images-rgb24", "network-images", "map-raster", "network-map", "solver",
    "map-check", "tracker", "can",
    // beside the frame
    "mjpeg-decode", "images-yuyv", "images-uyvy", "images-nv12", "images-bayer_rggb",
    "images-mjpeg", "view-table", "map-crop", "network-mask", "solver-acquiring"};

struct Stage {
  std::string name;
  bool in_frame = false;  ///< on the way of every frame in the steady state
  Work work;
  std::function<void()> run;
};

/// The pipeline's own classes, with buffers of their own. Run in their order, the stages that are
/// in a frame do what the daemon does for one. Not thread safe.
class Stages {
 public:
  /// Fails as Network::load() and make_solver() do. What it is given must outlive it.
  static Result<std::unique_ptr<Stages>> create(const firmware::Config& config, const Scene& scene,
                                                const MapIndex& index, int threads);
  ~Stages();

  /// In the order of kStageNames.
  const std::vector<Stage>& all() const { return stages_; }

  void go_to(const Place& place);

  /// The next frame: the vehicle's samples up to it, its pictures; not timed.
  void begin_frame(const Pictures& pictures);

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
