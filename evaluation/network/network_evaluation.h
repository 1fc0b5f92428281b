// Evaluates a model on simulated samples, with the daemon's own network and solvers.
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
#include "evaluation/baselines/baseline.h"
#include "evaluation/solver/mask_input.h"
#include "evaluation/solver/mask_scales.h"
#include "evaluation/solver/read_out_case.h"
#include "evaluation/solver/solver_score.h"
#include "pipeline/bev_grid.h"
#include "pipeline/network/network.h"
#include "pipeline/network/view/view_table.h"
#include "pipeline/solver/solver_factory.h"
#include "sim/samples/sample_maker.h"

namespace bevloc::evaluation {

inline constexpr int kMostFrames = 100'000;

/// World seeds reserved for each seed of the command line.
inline constexpr uint64_t kWorldsPerSeed = 1ULL << 16U;
inline constexpr uint64_t kSampleSeeds = sim::kSampleSeedCount / kWorldsPerSeed;

/// The first world of the samples for a seed of the command line.
constexpr uint64_t first_seed_of(uint64_t seed) {
  return sim::kEvaluationSampleSeedBase + seed * kWorldsPerSeed;
}

/// Number of samples taken from each world. It is small, so that many worlds are seen.
inline constexpr uint64_t kSamplesTakenPerWorld = 4;

/// The outcomes of one method. The method "prior" always answers with a correction of zero.
struct ReadOut {
  std::string name;                        ///< "prior", or of the solver or the baseline
  std::optional<ReadOutCase> solver_case;  ///< if the method is a solver
  std::vector<Outcome> outcomes;           ///< one per sample
};

struct SetResult {
  sim::NuisanceSet set = sim::NuisanceSet::kStandard;
  std::vector<ReadOut> read_outs;
  /// By ElementClass: the IoU of the perceived mask with the world's own map at the true pose.
  /// Intersection and union are summed over all samples.
  std::array<double, kRasterChannels> iou{};
};

/// A model with its solvers, and the baselines. One thread.
class NetworkEvaluation {
 public:
  /// Fails as Network::load() does. If `rows` contains solvers on masks, their scales are tuned
  /// first, on `tuning_samples` samples of the standard set whose seeds no evaluation uses.
  static Result<NetworkEvaluation> create(const std::string& model,
                                          ReadOutRows rows = ReadOutRows::kSolvers,
                                          int tuning_samples = 40);

  /// Evaluates the first `samples` samples of the stream, kSamplesTakenPerWorld of each world.
  /// Calls `progress` after each one.
  SetResult run(const sim::SampleStream& stream, int samples,
                const std::function<void()>& progress);

  const std::string& model_name() const { return network_->name(); }
  /// What the model states about its cameras.
  const ModelRig& model_rig() const { return network_->rig(); }

 private:
  /// Numbers of cells by class: cells in both the perceived mask and the map, and cells in at least
  /// one of them.
  struct Overlap {
    std::array<uint64_t, kRasterChannels> both{};
    std::array<uint64_t, kRasterChannels> either{};
  };

  /// A solver and its input.
  struct Reader {
    ReadOutCase read_out;
    std::unique_ptr<Solver> solver;
    const MaskInput* masks = nullptr;  ///< null: it matches the network's features
  };
  struct NamedBaseline {
    std::string name;
    std::unique_ptr<Baseline> baseline;
  };

  explicit NetworkEvaluation(std::unique_ptr<Network> network) : network_(std::move(network)) {}
  Status add_solvers(const std::vector<ReadOutCase>& cases, int tuning_samples);
  void add_baselines();
  /// Makes samples with the masks that the cases match; none if the cases match no masks.
  std::vector<TuningSample> make_tuning_samples(const std::vector<ReadOutCase>& cases, int samples);
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
  std::vector<float> perceived_;  ///< the probabilities of the network's mask
  std::vector<float> truth_;      ///< the mask of a network without errors
  ViewTable view_table_;
  SolverResult solution_;
};

}  // namespace bevloc::evaluation
