// Runs a model on samples of the simulator, through the daemon's own network and solvers.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/result.h"
#include "firmware/evaluation/baselines/baseline.h"
#include "firmware/evaluation/mask_input.h"
#include "firmware/evaluation/mask_scales.h"
#include "firmware/evaluation/read_out_case.h"
#include "firmware/evaluation/solver_score.h"
#include "pipeline/bev_grid.h"
#include "pipeline/network/network.h"
#include "pipeline/network/view_table.h"
#include "pipeline/solver/solver_factory.h"
#include "sim/samples/sample_maker.h"

namespace bevloc::evaluation {

/// Samples of one world that are looked at: few, so that many worlds are.
inline constexpr uint64_t kFramesPerWorld = 4;

/// The corrections of one way to get a pose; the prior's are all zero.
struct ReadOut {
  std::string name;                        ///< "prior", the solver's or the baseline's
  std::optional<ReadOutCase> solver_case;  ///< if it is a solver
  std::vector<Outcome> outcomes;           ///< one for each frame
};

struct SetResult {
  sim::NuisanceSet set = sim::NuisanceSet::kStandard;
  std::vector<ReadOut> read_outs;
  /// Of the mask perceived against the world's own map at the true pose, by ElementClass;
  /// intersection and union are summed over the frames.
  std::array<double, kRasterChannels> iou{};
};

/// A model with its solvers, and the baselines beside it. Not thread safe.
class NetworkEvaluation {
 public:
  /// Fails as Network::load() does. Where `rows` has solvers on masks, their scales are found
  /// first, on so many frames of the standard set with seeds that no evaluation has.
  static Result<NetworkEvaluation> create(const std::string& model,
                                          ReadOutRows rows = ReadOutRows::kSolvers,
                                          int tuning_frames = 40);

  /// Looks at `frames` samples of the stream. `progress` is called after each one.
  SetResult run(const sim::SampleStream& stream, int frames, const std::function<void()>& progress);

  const std::string& model_name() const { return network_->name(); }

 private:
  /// Pixels in which the mask perceived and the map's agree, and those of either.
  struct Overlap {
    std::array<uint64_t, kRasterChannels> both{};
    std::array<uint64_t, kRasterChannels> either{};
  };

  /// A solver, and what it reads.
  struct Reader {
    ReadOutCase read_out;
    std::unique_ptr<Solver> solver;
    const MaskInput* masks = nullptr;  ///< null: the network's features
  };
  struct NamedBaseline {
    std::string name;
    std::unique_ptr<Baseline> baseline;
  };

  explicit NetworkEvaluation(std::unique_ptr<Network> network) : network_(std::move(network)) {}
  Status add_solvers(const std::vector<ReadOutCase>& cases, int tuning_frames);
  void add_baselines();
  /// With the masks that the cases read; none where they read no mask.
  std::vector<TuningFrame> look_at_tuning_frames(const std::vector<ReadOutCase>& cases, int frames);
  std::vector<ReadOut> empty_read_outs() const;
  void perceive(const sim::Sample& sample);
  void take_probabilities();
  void take_truth(const sim::Sample& sample);
  void judge_all(const sim::Sample& sample, std::vector<ReadOut>& read_outs);
  void judge_solvers(const Se2& correction, std::span<ReadOut> read_outs);
  void judge_baselines(const sim::Sample& sample, std::span<ReadOut> read_outs);
  void add_overlap(const sim::Sample& sample, Overlap& overlap) const;

  std::unique_ptr<Network> network_;
  std::vector<Reader> readers_;
  std::vector<NamedBaseline> baselines_;
  MaskInputs mask_inputs_;
  MaskInputs true_mask_inputs_;
  std::vector<float> perceived_;  ///< the mask's probabilities
  std::vector<float> truth_;      ///< what a network without errors would perceive
  ViewTable view_table_;
  SolverResult solution_;
};

}  // namespace bevloc::evaluation
