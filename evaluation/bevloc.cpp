// The command bevloc: evaluates, tunes, benchmarks and draws parts of the appliance.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/version.h"
#include "evaluation/bench/bench_command.h"
#include "evaluation/calib/calib_command.h"
#include "evaluation/calib/calib_evaluation.h"
#include "evaluation/campaign/campaign_command.h"
#include "evaluation/campaign/integrity_command.h"
#include "evaluation/campaign/tune_matches_command.h"
#include "evaluation/drive/fault_command.h"
#include "evaluation/localize/localize_command.h"
#include "evaluation/network/answer_command.h"
#include "evaluation/network/network_command.h"
#include "evaluation/network/rig_command.h"
#include "evaluation/solver/draw_command.h"
#include "evaluation/solver/solver_command.h"

namespace {

/// Exit codes: 0 success; 1 what was checked is not good; 2 bad input or environment, with one line
/// on stderr.
constexpr int kNotGood = 1;
constexpr int kBadInput = 2;

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Evaluates, tunes, benchmarks and draws parts of the appliance");
  app.set_version_flag("--version", std::string(bevloc::version()));
  app.require_subcommand(1);
  auto* eval = app.add_subcommand("eval", "Evaluate a part on scenes that no tuning has used");
  eval->require_subcommand(1);
  auto* tune = app.add_subcommand("tune", "Find the parameters of a part on tuning scenes");
  tune->require_subcommand(1);
  bevloc::evaluation::SolverCommand solver_command;
  solver_command.declare_eval(*eval);
  bevloc::evaluation::NetworkCommand network_command;
  network_command.declare(*eval);
  bevloc::evaluation::RigCommand rig_command;
  rig_command.declare(*eval);
  bevloc::evaluation::IntegrityCommand integrity_command;
  integrity_command.declare(*eval);
  bevloc::evaluation::CalibEvaluation calib_evaluation;
  calib_evaluation.declare(*eval);
  solver_command.declare_tune(*tune);
  bevloc::evaluation::TuneMatchesCommand tune_matches_command;
  tune_matches_command.declare(*tune);
  auto* draw =
      app.add_subcommand("draw", "Write the data of the figures that script/figures draws");
  draw->require_subcommand(1);
  bevloc::evaluation::DrawCommand draw_command;
  draw_command.declare(*draw);
  bevloc::bench::BenchCommand bench_command;
  bench_command.declare(app);
  bevloc::evaluation::AnswerCommand answer_command;
  answer_command.declare(app);
  bevloc::evaluation::CalibCommand calib_command;
  calib_command.declare(app);
  bevloc::evaluation::CampaignCommand campaign_command;
  campaign_command.declare(app);
  bevloc::evaluation::FaultCommand fault_command;
  fault_command.declare(app);
  bevloc::evaluation::LocalizeCommand localize_command;
  localize_command.declare(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  if (calib_command.chosen()) {
    const bevloc::Result<bool> good = calib_command.run();
    if (good) return *good ? 0 : kNotGood;
    fmt::print(stderr, "bevloc: {}\n", good.error().message);
    return kBadInput;
  }
  const bevloc::Status status = draw->parsed()                  ? draw_command.run()
                                : campaign_command.chosen()     ? campaign_command.run()
                                : calib_evaluation.chosen()     ? calib_evaluation.run()
                                : integrity_command.chosen()    ? integrity_command.run()
                                : tune_matches_command.chosen() ? tune_matches_command.run()
                                : bench_command.chosen()        ? bench_command.run()
                                : answer_command.chosen()       ? answer_command.run()
                                : fault_command.chosen()        ? fault_command.run()
                                : localize_command.chosen()     ? localize_command.run()
                                : network_command.chosen()      ? network_command.run()
                                : rig_command.chosen()          ? rig_command.run()
                                                                : solver_command.run();
  if (status) return 0;
  fmt::print(stderr, "bevloc: {}\n", status.error().message);
  return kBadInput;
}
