// The command bevloc with the simulator: evaluates, tunes, benchmarks and draws parts of the
// appliance. It also has the commands of command/, which need no simulator.
#include <CLI/CLI.hpp>

#include "command/vehicle_commands.h"
#include "evaluation/bench/bench_command.h"
#include "evaluation/calib/calib_command.h"
#include "evaluation/calib/calib_evaluation.h"
#include "evaluation/campaign/campaign_command.h"
#include "evaluation/campaign/integrity_command.h"
#include "evaluation/campaign/tune_matches_command.h"
#include "evaluation/drive/demo_command.h"
#include "evaluation/drive/drive_config.h"
#include "evaluation/drive/fault_command.h"
#include "evaluation/localize/localize_command.h"
#include "evaluation/maps/map_command.h"
#include "evaluation/network/answer_command.h"
#include "evaluation/network/network_command.h"
#include "evaluation/network/rig_command.h"
#include "evaluation/recording/record_command.h"
#include "evaluation/recording/replay_command.h"
#include "evaluation/report/report_command.h"
#include "evaluation/solver/draw_command.h"
#include "evaluation/solver/solver_command.h"

namespace {

using namespace bevloc::evaluation;

CLI::App& add_group(CLI::App& app, const std::string& name, const std::string& description) {
  auto* group = app.add_subcommand(name, description);
  group->require_subcommand(1);
  return *group;
}

void add_evaluation_commands(CLI::App& app, bevloc::command::CommandList& commands) {
  auto& eval =
      add_group(app, "eval", "Evaluate solvers, networks, rigs, calibrations and integrity");
  auto& tune = add_group(app, "tune", "Find the parameters of a part on tuning scenes");
  auto& draw = add_group(app, "draw", "Write the data of the figures that script/figures draws");
  commands.add<SolverCommand>(eval, tune);
  commands.add<NetworkCommand>(eval);
  commands.add<RigCommand>(eval);
  commands.add<CalibEvaluation>(eval);
  commands.add<IntegrityCommand>(eval);
  commands.add<TuneMatchesCommand>(tune);
  commands.add<DrawCommand>(draw);
  commands.add<bevloc::bench::BenchCommand>(app);
  commands.add<DemoCommand>(app);
  commands.add<AnswerCommand>(app);
  commands.add<CampaignCommand>(app);
  commands.add<FaultCommand>(app);
  commands.add<LocalizeCommand>(app);
  commands.add<MapCommand>(app);
  commands.add<CalibCommand>(app);
  commands.add<RecordCommand>(app);
  commands.add<ReplayCommand>(app);
  commands.add<ReportCommand>(app);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Sets up, checks, evaluates, tunes, benchmarks and draws parts of the appliance");
  std::optional<SimulationConfig> simulation;
  const bevloc::firmware::SimulationReader reader = simulation_reader(simulation);
  bevloc::command::CommandList commands;
  bevloc::command::add_vehicle_commands(app, commands, &reader);
  add_evaluation_commands(app, commands);
  return commands.run(app, argc, argv);
}
