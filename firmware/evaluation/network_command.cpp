#include "firmware/evaluation/network_command.h"

#include <cstdio>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "firmware/evaluation/command_output.h"
#include "firmware/evaluation/network_evaluation.h"
#include "firmware/evaluation/network_report.h"
#include "pipeline/map/map_loader.h"

namespace bevloc::evaluation {
namespace {

constexpr int kMostFrames = 100'000;
/// Worlds of one seed.
constexpr uint64_t kWorldsPerSeed = 1ULL << 16U;
static_assert(kMostFrames / kFramesPerWorld < kWorldsPerSeed);
constexpr uint64_t kSeeds = sim::kSampleSeedCount / kWorldsPerSeed;

constexpr const char* kAllSets = "all";

Result<HdMap> load_drivable_map(const std::string& file) {
  auto map = load_map(file);
  if (map && map->lanes.empty()) return fail("{}: found no lanes, wanted some to drive on", file);
  return map;
}

}  // namespace

void NetworkCommand::declare(CLI::App& eval) {
  auto* network = eval.add_subcommand(
      "network", "A model on samples of the simulator, read out by several solvers");
  network->add_option("--model", model_, "ONNX file")->capture_default_str();
  network
      ->add_option("--set", set_,
                   "What may be wrong in a sample: a set's name (docs/evaluation.md), or all")
      ->capture_default_str();
  const std::map<std::string, ReadOutRows> rows{{"solvers", ReadOutRows::kSolvers},
                                                {"variants", ReadOutRows::kVariants},
                                                {"baselines", ReadOutRows::kBaselines},
                                                {"all", ReadOutRows::kAll}};
  network
      ->add_option("--rows", rows_,
                   "solvers (on the model's features), variants (masks, sizes and steps of the "
                   "paper's Tables III and IV too), baselines (without learned matching) or all")
      ->transform(CLI::CheckedTransformer(rows))
      ->default_str("solvers");
  network->add_option("--frames", frames_, "How many frames of each set")
      ->check(CLI::Range(1, kMostFrames))
      ->capture_default_str();
  network->add_option("--seed", seed_, "Which frames")
      ->check(CLI::Range(uint64_t{0}, kSeeds - 1))
      ->capture_default_str();
  network->add_option("--map", map_file_, "Drive on this map in place of made-up towns");
  network->add_option("--json", json_file_, "Write the rows as JSON to this file");
  network->add_option("--csv", csv_file_, "Write the rows as CSV to this file");
  network->callback([this] { chosen_ = true; });
}

Result<std::vector<sim::NuisanceSet>> NetworkCommand::sets() const {
  if (set_ == kAllSets) {
    const auto all = sim::all_nuisance_sets();
    return std::vector(all.begin(), all.end());
  }
  return sim::nuisance_set_from(set_).map([](sim::NuisanceSet set) { return std::vector{set}; });
}

Status NetworkCommand::run() const {
  const auto chosen_sets = sets();
  if (!chosen_sets) return tl::unexpected(chosen_sets.error());
  std::optional<HdMap> map;
  if (!map_file_.empty()) {
    auto loaded = load_drivable_map(map_file_);
    if (!loaded) return tl::unexpected(loaded.error());
    map = std::move(*loaded);
  }
  auto evaluation = NetworkEvaluation::create(model_, rows_);
  if (!evaluation) return tl::unexpected(evaluation.error());

  const NetworkEvaluationSubject subject{evaluation->model_name(), map_file_, frames_, seed_};
  fmt::print("{}, {} frames a set, seed {}, {}\n", subject.model, frames_, seed_,
             map ? map_file_ : "made-up towns");
  sim::SampleStream stream;
  stream.first_seed = sim::kEvaluationSampleSeedBase + seed_ * kWorldsPerSeed;
  stream.map = map ? &*map : nullptr;
  std::vector<SetResult> results;
  int done = 0;
  const int all = frames_ * static_cast<int>(chosen_sets->size());
  for (const sim::NuisanceSet set : *chosen_sets) {
    stream.nuisances = sim::nuisances_of(set);
    results.push_back(evaluation->run(stream, frames_, [&] { show_progress(++done, all); }));
    results.back().set = set;
    fmt::print("\n{}", table_of(results.back()));
    std::fflush(stdout);
  }
  if (Status status = write_file(to_json(results, subject), json_file_); !status) return status;
  return write_file(to_csv(results), csv_file_);
}

}  // namespace bevloc::evaluation
