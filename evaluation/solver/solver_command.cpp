#include "evaluation/solver/solver_command.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/choice_option.h"
#include "evaluation/progress_bar.h"
#include "evaluation/solver/scale_tuning.h"
#include "evaluation/solver/solver_report.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

/// Town seeds reserved for each seed of the command line.
constexpr uint64_t kTownsPerSeed = 1ULL << 20U;
constexpr uint64_t kSceneSeeds = sim::kSceneSeedCount / kTownsPerSeed;
constexpr uint64_t kMostScenes = sim::scenes_of(kTownsPerSeed);
/// One run of tuning may use all town seeds that are reserved for tuning.
constexpr uint64_t kMostTuningScenes = 100'000;
static_assert(kMostTuningScenes <= sim::scenes_of(sim::kSceneSeedCount));

}  // namespace

void SolverCommand::declare(CLI::App& eval, CLI::App& tune) {
  declare_eval(eval);
  declare_tune(tune);
}

void SolverCommand::declare_eval(CLI::App& eval) {
  auto* solver = eval.add_subcommand("solver", "Compare all solvers on synthetic scenes");
  solver->add_option("--scenes", scenes_, "Number of scenes")
      ->check(CLI::Range(uint64_t{1}, kMostScenes))
      ->capture_default_str();
  solver->add_option("--seed", seed_, "Seed of the scenes")
      ->check(CLI::Range(uint64_t{0}, kSceneSeeds - 1))
      ->capture_default_str();
  add_choice(*solver, "--corruption", corruption_,
             {{"clean", sim::CorruptionLevel::kClean},
              {"mild", sim::CorruptionLevel::kMild},
              {"paper", sim::CorruptionLevel::kPaper},
              {"hard", sim::CorruptionLevel::kHard}},
             "Errors of the perceived masks; \"paper\" gives the IoU of the paper's Table II");
  declare_rows(*solver);
  solver->add_option("--json", json_file_, "Write the rows as JSON to this file")
      ->check(output_file());
  solver->add_option("--csv", csv_file_, "Write the rows as CSV to this file")
      ->check(output_file());
  solver->footer(
      "Examples:\n"
      "  bevloc eval solver --scenes 200\n"
      "  bevloc eval solver --corruption hard --rows variants --json solver.json");
}

void SolverCommand::declare_rows(CLI::App& command) {
  add_choice(command, "--rows", rows_,
             {{"variants", Rows::kVariants},
              {"table3", Rows::kTableThree},
              {"table4", Rows::kTableFour},
              {"all", Rows::kAll}},
             "variants: every solver at 100x50x16; table3, table4: as in the paper");
}

void SolverCommand::declare_tune(CLI::App& tune) {
  auto* solver = tune.add_subcommand(
      "solver", "Find the softmax scales for hand-made features (`bevloc eval solver` uses them)");
  solver->add_option("--scenes", scenes_, "Number of tuning scenes")
      ->check(CLI::Range(uint64_t{1}, kMostTuningScenes))
      ->capture_default_str();
  declare_rows(*solver);
  solver->footer(
      "Examples:\n"
      "  bevloc tune solver --scenes 1000 --rows variants");
  solver->callback([this] { tunes_ = true; });
}

Status SolverCommand::run() const {
  return tunes_ ? tune() : evaluate();
}

std::vector<SolverCase> SolverCommand::cases() const {
  std::vector<SolverCase> all;
  const auto add = [&all](const std::vector<SolverCase>& more) {
    for (const SolverCase& candidate : more) {
      if (std::ranges::find(all, candidate) == all.end()) all.push_back(candidate);
    }
  };
  if (rows_ == Rows::kVariants || rows_ == Rows::kAll) add(variant_cases());
  if (rows_ == Rows::kTableThree || rows_ == Rows::kAll) add(table_three_cases());
  if (rows_ == Rows::kTableFour || rows_ == Rows::kAll) add(table_four_cases());
  return all;
}

Status SolverCommand::evaluate() const {
  EvaluationOptions options;
  options.seed_base = sim::kEvaluationSeedBase + seed_ * kTownsPerSeed;
  options.scenes = scenes_;
  options.corruption = corruption_;
  const std::vector<SolverCase> all = cases();
  std::vector<SolverParameters> parameters;
  std::ranges::transform(all, std::back_inserter(parameters), hand_made_parameters);
  const auto results = evaluate_solvers(all, parameters, options,
                                        [this](int done) { show_progress(done, scenes_); });
  if (!results) return tl::unexpected(results.error());
  fmt::print("{} scenes, corruption {}, seed {}\n\n{}\n{}\n", scenes_, sim::name(corruption_),
             seed_, accuracy_table(*results), cost_table(*results));
  for (const CaseResult& result : *results) {
    const SolverKind kind = result.solver_case.solver;
    const bool wanted = kind == SolverKind::kFullFft || kind == SolverKind::kDecoupledRefined ||
                        kind == SolverKind::kBandedRefined;
    if (wanted && result.solver_case == SolverCase{.solver = kind}) {
      fmt::print("{} by road\n{}\n", name_of(kind), road_table(result));
    }
  }
  fmt::print("{}", paper_comparison(*results));
  if (Status status = write_option_file(json_file_, to_json(*results, options, seed_)); !status) {
    return status;
  }
  return write_option_file(csv_file_, to_csv(*results));
}

/// One case of each group that shares its scales.
std::vector<SolverCase> SolverCommand::cases_to_tune() const {
  std::vector<SolverCase> chosen = cases();
  std::erase_if(chosen, [](const SolverCase& c) {
    const bool shares_full_fft = c.solver == SolverKind::kFull;
    const bool shares_refinement =
        is_refined(c.solver) && c.solver != SolverKind::kDecoupledRefined;
    return c.step_m != SolverCase{}.step_m || shares_full_fft || shares_refinement;
  });
  return chosen;
}

Status SolverCommand::tune() const {
  EvaluationOptions options;
  options.seed_base = sim::kTuningSeedBase;
  options.scenes = scenes_;
  for (const SolverCase& solver_case : cases_to_tune()) {
    const auto tuned = tune_scales(solver_case, options);
    if (!tuned) return tl::unexpected(tuned.error());
    fmt::print("{:24} {:>7} {:>2} {:.1f}: {}\n", name_of(solver_case.solver),
               size_name(solver_case.grid), solver_case.channels, solver_case.step_m,
               describe(*tuned));
    std::fflush(stdout);
  }
  return {};
}

}  // namespace bevloc::evaluation
