// bevlocd: tells a vehicle where it stands in its HD map.
#include <atomic>
#include <csignal>

#include <CLI/CLI.hpp>
#include <malloc.h>
#include <spdlog/spdlog.h>

#include "common/files.h"
#include "drivers/gpio/libgpiod_gpio.h"
#include "firmware/daemon.h"
#include "firmware/simulation/simulated_run.h"
#include "pipeline/calibration/rig_yaml.h"

namespace {

using namespace bevloc;
using namespace bevloc::firmware;

/// Exit codes: 0 done, 2 something outside is wrong (one line on stderr says what).
constexpr int kBadInput = 2;

std::atomic<bool> g_stop_requested{false};

void request_stop(int) {
  g_stop_requested = true;
}

struct CommandLine {
  std::string config_file;
  bool check_config = false;
  // With mock cameras only; each overrides the configuration.
  std::optional<uint64_t> seed;
  std::optional<double> duration_s;
  std::string map_file;
  std::string out = "out";
  std::string json_file;
  bool fast = false;
};

void declare(CLI::App& app, CommandLine& line) {
  app.set_version_flag("--version", BEVLOC_VERSION);
  app.add_option("--config", line.config_file, "Configuration file")->required();
  app.add_flag("--check-config", line.check_config,
               "Read the configuration and what it names, say what is wrong with it, and end");
  auto* simulation = app.add_option_group("Simulated drive (mock cameras)");
  simulation->add_option("--seed", line.seed, "Seed of the made-up town, the drive and all noise");
  simulation->add_option("--duration", line.duration_s, "Length of the drive, seconds")
      ->check(CLI::PositiveNumber);
  simulation->add_option("--map", line.map_file, "Drive through this HD map (.osm or .bvm)");
  simulation->add_option("--out", line.out, "Folder for can.log, poses.csv and sheet.png");
  simulation->add_option("--json", line.json_file, "Write the result as JSON to this file");
  simulation->add_flag("--fast", line.fast, "Virtual clock: as quick as it can, and repeatable");
}

Status apply(const CommandLine& line, Config& config) {
  const bool asks_for_simulation = line.seed || line.duration_s || !line.map_file.empty() ||
                                   !line.json_file.empty() || line.fast;
  if (!config.simulation) {
    if (!asks_for_simulation) return {};
    return fail(
        "{}: found cameras that are not mock, wanted mock ones for --seed, --duration, "
        "--map, --json and --fast",
        line.config_file);
  }
  if (line.seed) {
    config.simulation->seed = *line.seed;
    if (config.map.procedural_seed) config.map.procedural_seed = *line.seed;
  }
  if (line.duration_s) config.simulation->duration_s = *line.duration_s;
  if (!line.map_file.empty()) {
    config.map.procedural_seed.reset();
    config.map.file = line.map_file;
  }
  return {};
}

Status simulate(const CommandLine& line, const Config& config, const Rig& rig) {
  SimulatedRunOptions options;
  options.fast = line.fast;
  options.out = line.out;
  const auto report = run_simulation(config, rig, options,
                                     [](const ApplianceView&) { return g_stop_requested.load(); });
  if (!report) return tl::unexpected(report.error());
  fmt::print("{}", to_table(*report));
  if (line.json_file.empty()) return {};
  return write_file(line.json_file, to_json(*report));
}

Status run(const CommandLine& line) {
  auto config = load_config(line.config_file);
  if (!config) return tl::unexpected(config.error());
  if (Status status = apply(line, *config); !status) return status;
  if (line.check_config) {
    if (Status status = check_config(*config); !status) return status;
    fmt::print("{}: good\n", line.config_file);
    return {};
  }
  set_log_level(config->log_level);
  const auto rig = read_rig(config->rig_file);
  if (!rig) return tl::unexpected(rig.error());
  if (config->simulation) return simulate(line, *config, *rig);
  drivers::LibgpiodGpio gpio;
  return run_daemon(*config, *rig, gpio, [] { return g_stop_requested.load(); });
}

}  // namespace

int main(int argc, char** argv) {
  // Threads allocate while they start and hardly ever again: an arena for each of them would only
  // keep what their starts left over.
  mallopt(M_ARENA_MAX, 1);
  std::signal(SIGTERM, request_stop);
  std::signal(SIGINT, request_stop);

  CLI::App app("Tells a vehicle where it stands in its HD map");
  CommandLine line;
  declare(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  const Status status = run(line);
  if (status) return 0;
  fmt::print(stderr, "bevlocd: {}\n", status.error().message);
  return kBadInput;
}
