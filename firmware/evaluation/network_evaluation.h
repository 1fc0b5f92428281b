// Runs a model on samples of the simulator, through the daemon's own network and solvers.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/result.h"
#include "firmware/evaluation/solver_score.h"
#include "pipeline/bev_grid.h"
#include "pipeline/network/network.h"
#include "pipeline/network/view_table.h"
#include "pipeline/solver/solver_factory.h"
#include "sim/samples/sample_maker.h"

namespace bevloc::evaluation {

/// Samples of one world that are looked at: few, so that many worlds are.
inline constexpr uint64_t kFramesPerWorld = 4;

/// The corrections of one way to read the features; the prior's are all zero.
struct ReadOut {
  std::string name;
  std::vector<Outcome> outcomes;  ///< one for each frame
};

struct SetResult {
  sim::NuisanceSet set = sim::NuisanceSet::kStandard;
  std::vector<ReadOut> read_outs;
  /// Of the mask perceived against the world's own map at the true pose, by ElementClass;
  /// intersection and union are summed over the frames.
  std::array<double, kRasterChannels> iou{};
};

/// A model with its solvers. Not thread safe.
class NetworkEvaluation {
 public:
  /// Fails as Network::load() does.
  static Result<NetworkEvaluation> create(const std::string& model);

  /// Looks at `frames` samples of the stream. `progress` is called after each one.
  SetResult run(const sim::SampleStream& stream, int frames, const std::function<void()>& progress);

  const std::string& model_name() const { return network_->name(); }

 private:
  /// Pixels in which the mask perceived and the map's agree, and those of either.
  struct Overlap {
    std::array<uint64_t, kRasterChannels> both{};
    std::array<uint64_t, kRasterChannels> either{};
  };

  explicit NetworkEvaluation(std::unique_ptr<Network> network) : network_(std::move(network)) {}
  void perceive(const sim::Sample& sample);
  void judge_all(const Se2& correction, std::vector<ReadOut>& read_outs);
  void add_overlap(const sim::Sample& sample, Overlap& overlap) const;

  std::unique_ptr<Network> network_;
  std::vector<std::unique_ptr<Solver>> solvers_;
  ViewTable view_table_;
  SolverResult solution_;
};

}  // namespace bevloc::evaluation
