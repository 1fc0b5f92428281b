// bevloc: measures and draws what the appliance is made of.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "firmware/bench/bench_command.h"
#include "firmware/evaluation/draw_command.h"
#include "firmware/evaluation/network_command.h"
#include "firmware/evaluation/solver_command.h"

namespace {

/// Exit codes: 0 done, 2 something outside is wrong (one line on stderr says what).
constexpr int kBadInput = 2;

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures and draws what the appliance is made of");
  app.set_version_flag("--version", BEVLOC_VERSION);
  app.require_subcommand(1);
  auto* eval = app.add_subcommand("eval", "Evaluate a part on scenes that nothing was tuned on");
  eval->require_subcommand(1);
  auto* tune = app.add_subcommand("tune", "Find a part's parameters on tuning scenes");
  tune->require_subcommand(1);
  bevloc::evaluation::SolverCommand solver_command;
  solver_command.declare_eval(*eval);
  bevloc::evaluation::NetworkCommand network_command;
  network_command.declare(*eval);
  solver_command.declare_tune(*tune);
  auto* draw = app.add_subcommand("draw", "Draw what a part reads and answers");
  draw->require_subcommand(1);
  bevloc::evaluation::DrawCommand draw_command;
  draw_command.declare(*draw);
  bevloc::bench::BenchCommand bench_command;
  bench_command.declare(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  const bevloc::Status status = draw->parsed()             ? draw_command.run()
                                : bench_command.chosen()   ? bench_command.run()
                                : network_command.chosen() ? network_command.run()
                                                           : solver_command.run();
  if (status) return 0;
  fmt::print(stderr, "bevloc: {}\n", status.error().message);
  return kBadInput;
}
