#include "evaluation/bench/bench_command.h"

#include <cstdio>

#include <fmt/format.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "common/shipped_file.h"
#include "evaluation/bench/bench_report.h"
#include "evaluation/bench/stages.h"
#include "evaluation/bench/sweeps.h"
#include "evaluation/progress_bar.h"
#include "firmware/config/files_of_config.h"

namespace bevloc::bench {
namespace {

constexpr int kMostFrames = 100'000;
constexpr int kMostThreads = 64;

template <size_t kCount>
std::vector<std::string> names(const std::array<std::string_view, kCount>& views) {
  return {views.begin(), views.end()};
}

}  // namespace

void BenchCommand::declare(CLI::App& app) {
  auto* bench = app.add_subcommand(
      "bench",
      "Measure the time of a frame, from six decoded images to CAN, and of each of its stages");
  bench->add_option("--config", config_file_, "Configuration of bevlocd")->capture_default_str();
  bench->add_option("--frames", options_.frames, "Number of frames; in a sweep, of each row")
      ->check(CLI::Range(1, kMostFrames))
      ->capture_default_str();
  bench->add_option("--threads", options_.threads, "Number of threads of the network")
      ->check(CLI::Range(1, kMostThreads))
      ->capture_default_str();
  auto* stages = bench->add_option("--stage", options_.stages, "Measure these stages only")
                     ->check(CLI::IsMember(names(kStageNames)));
  bench->add_option("--sweep", sweeps_, "Instead of a frame, measure how the time grows with this")
      ->check(CLI::IsMember(names(kSweepNames)))
      ->excludes(stages);
  bench->add_flag("!--no-peak", options_.measures_peak, "Do not measure the peak of the machine");
  bench->add_option("--json", json_file_, "Write the results as JSON to this file")
      ->check(output_file());
  bench->footer(
      "Examples:\n"
      "  bevloc bench --json bench.json\n"
      "  bevloc bench --stage solver map-raster\n"
      "  bevloc bench --sweep map hypotheses");
}

Status BenchCommand::run() const {
  const auto config = evaluation::load_drive_config(given_or_shipped(config_file_));
  if (!config) return tl::unexpected(config.error());
  if (Status other = check_output(json_file_, files_of(*config)); !other) return other;
  return sweeps_.empty() ? measure(*config) : sweep(*config);
}

Status BenchCommand::measure(const evaluation::DriveConfig& config) const {
  const auto result =
      run_bench(config, options_, [](int done, int all) { evaluation::show_progress(done, all); });
  if (!result) return tl::unexpected(result.error());
  fmt::print("{}", table_of(*result));
  return write_option_file(json_file_, to_json(*result));
}

Status BenchCommand::sweep(const evaluation::DriveConfig& config) const {
  SweepOptions options;
  options.frames = options_.frames;
  options.threads = options_.threads;
  std::vector<SweepResult> results;
  for (const std::string& name : sweeps_) {
    const auto result = run_sweep(name, config, options);
    if (!result) return tl::unexpected(result.error());
    fmt::print("{}\n", table_of(*result));
    std::fflush(stdout);
    results.push_back(*result);
  }
  return write_option_file(json_file_, to_json(results));
}

}  // namespace bevloc::bench
