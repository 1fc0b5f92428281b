#include "evaluation/network/network_command.h"

#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "common/shipped_file.h"
#include "evaluation/check_outputs.h"
#include "evaluation/choice_option.h"
#include "evaluation/drivable_map.h"
#include "evaluation/network/network_evaluation.h"
#include "evaluation/network/network_report.h"
#include "evaluation/progress_bar.h"

namespace bevloc::evaluation {
namespace {

constexpr const char* kAllSets = "all";

}  // namespace

void NetworkCommand::declare(CLI::App& eval) {
  auto* network =
      eval.add_subcommand("network", "Evaluate a model with several solvers on simulated samples");
  network->add_option("--model", model_, "ONNX file")->capture_default_str();
  network
      ->add_option("--set", set_,
                   "Nuisances of the samples: the name of a set (docs/evaluation.md), or all")
      ->capture_default_str();
  add_choice(
      *network, "--rows", rows_,
      {{"solvers", ReadOutRows::kSolvers},
       {"variants", ReadOutRows::kVariants},
       {"baselines", ReadOutRows::kBaselines},
       {"all", ReadOutRows::kAll}},
      "solvers: on the model's features; variants: also masks, sizes and steps of the paper's "
      "Tables III and IV; baselines: methods without learned matching");
  network->add_option("--frames", frames_, "Number of samples of each set")
      ->check(CLI::Range(1, kMostFrames))
      ->capture_default_str();
  network->add_option("--seed", seed_, "Seed of the samples")
      ->check(CLI::Range(uint64_t{0}, kSampleSeeds - 1))
      ->capture_default_str();
  network
      ->add_option("--map", map_file_,
                   "Take the samples on this map instead of in procedural towns")
      ->check(is_name_of("a map"));
  network->add_option("--json", json_file_, "Write the rows as JSON to this file")
      ->check(output_file());
  network->add_option("--csv", csv_file_, "Write the rows as CSV to this file")
      ->check(output_file());
  network->footer(
      "Examples:\n"
      "  bevloc eval network --frames 50\n"
      "  bevloc eval network --set all --csv sets.csv\n"
      "  bevloc eval network --model my.onnx --set night --json night.json");
}

Result<std::vector<sim::NuisanceSet>> NetworkCommand::sets() const {
  if (set_ == kAllSets) {
    const auto all = sim::all_nuisance_sets();
    return std::vector(all.begin(), all.end());
  }
  return sim::nuisance_set_from(set_).map([](sim::NuisanceSet set) { return std::vector{set}; });
}

Status NetworkCommand::run() const {
  const std::string model = given_or_shipped(model_);
  if (Status others = check_outputs({json_file_, csv_file_}, {map_file_, model}); !others) {
    return others;
  }
  const auto chosen_sets = sets();
  if (!chosen_sets) return tl::unexpected(chosen_sets.error());
  std::optional<HdMap> map;
  if (!map_file_.empty()) {
    auto loaded = load_drivable_map(map_file_);
    if (!loaded) return tl::unexpected(loaded.error());
    map = std::move(*loaded);
  }
  auto evaluation = NetworkEvaluation::create(model, rows_);
  if (!evaluation) return tl::unexpected(evaluation.error());

  const NetworkEvaluationSubject subject{evaluation->model_name(), map_file_, frames_, seed_};
  fmt::print("{}, {} samples per set, seed {}, {}\n", subject.model, frames_, seed_,
             map ? map_file_ : "procedural towns");
  sim::SampleStream stream;
  stream.first_seed = first_seed_of(seed_);
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
  if (Status status = write_option_file(json_file_, to_json(results, subject)); !status) {
    return status;
  }
  return write_option_file(csv_file_, to_csv(results));
}

}  // namespace bevloc::evaluation
