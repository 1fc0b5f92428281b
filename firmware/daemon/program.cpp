#include "firmware/daemon/program.h"

#include <atomic>
#include <csignal>

#include <fcntl.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "common/number_text.h"
#include "common/option_checks.h"
#include "common/output.h"
#include "common/version.h"
#include "firmware/config/config_key.h"
#include "firmware/devices/config_check.h"
#include "firmware/recording/recording_ring.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::firmware {
namespace {

std::atomic<bool> g_stop_requested{false};
std::atomic<bool> g_hangup{false};

void request_stop(int) {
  g_stop_requested = true;
}

void note_hangup(int) {
  g_hangup = true;
}

/// Opens standard files that are closed. Otherwise a file that is opened later could get the number
/// of stdout or stderr, and the log would be written into a camera.
void open_closed_standard_files() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(file, F_GETFD) == -1) open("/dev/null", O_RDWR);
  }
}

/// Takes the value of --live. If it has no port, CLI11 gives "true".
void take_live_option(const std::string& port, ProgramOptions& options) {
  options.live = true;
  if (port.empty() || port == "true") return;
  const auto number = parse_number<int>(port);
  if (!number || *number < 1 || *number > 65535) {
    throw CLI::ValidationError("--live", fmt::format("found {}, wanted a port, 1 to 65535", port));
  }
  options.live_port = *number;
}

}  // namespace

void declare_options(CLI::App& app, ProgramOptions& options) {
  app.set_version_flag("--version", std::string(version()));
  app.add_option("--config", options.config_file, "Configuration file")
      ->required()
      ->check(is_name_of("a configuration"));
  app.add_flag("--check-config", options.check_config,
               "Check the configuration and everything that it names, then exit");
  app.add_option_function<std::string>(
         "--live", [&options](const std::string& port) { take_live_option(port, options); },
         "Serve the live page at http://127.0.0.1:PORT/ (8080)")
      ->expected(0, 1)
      ->type_name("[PORT]");
  app.add_option("--record", options.record,
                 "Record images, bus and poses into this folder (docs/recording.md)")
      ->check(is_name_of("a folder"));
  app.add_flag("--record-raw", options.record_raw,
               "Record the images without loss, so that a replay gives the same poses");
}

Status override_config(const ProgramOptions& options, Config& config) {
  if (!options.record.empty()) {
    if (!config.record) config.record.emplace();
    config.record->directory = options.record;
  }
  if (options.record_raw) {
    if (!config.record) {
      return fail("--record-raw: found no recording, wanted --record DIR or the section record");
    }
    config.record->images = RecordedImages::kRaw;
  }
  if (!options.live) return {};
  if (!config.live) config.live.emplace();
  if (options.live_port) config.live->port = *options.live_port;
  return {};
}

Result<Rig> rig_of(const Config& config) {
  const std::string file = config.rig_file.string();
  const auto parse = [&file](const std::string& text) { return parse_rig(text, file); };
  auto rig = at_key("calibration.rig", config.kept_files.bytes_of(config.rig_file).and_then(parse));
  if (!rig) return rig;
  if (Status shown = check_shown(*rig, file); !shown) return tl::unexpected(shown.error());
  return rig;
}

void handle_signals() {
  std::signal(SIGTERM, request_stop);
  std::signal(SIGINT, request_stop);
  std::signal(SIGHUP, note_hangup);
  // Ignored, so that a write into a closed pipe fails instead of ending the process.
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_requested() {
  if (g_hangup.exchange(false)) {
    spdlog::info("SIGHUP ignored: restart the service to read the configuration again");
  }
  return g_stop_requested;
}

Status check_and_print(const ProgramOptions& options, const Config& config) {
  if (Status status = check_config(config); !status) return status;
  if (config.record) {
    if (Status status = check_folder(config.record->directory); !status) return status;
  }
  fmt::print("{}: good\n", options.config_file);
  return {};
}

int run_program(CLI::App& app, int argc, char** argv, const Run& run) {
  // All threads share one heap arena. They allocate at their start and hardly ever later, so
  // separate arenas would only keep unused memory.
  mallopt(M_ARENA_MAX, 1);
  open_closed_standard_files();
  handle_signals();
  if (const auto ended = parse_options(app, argc, argv)) return *ended;
  const LogWriter log;
  const Status status = run_without_throwing([&] { return run(log); });
  if (status) return 0;
  write_with_patience(STDERR_FILENO,
                      fmt::format("bevlocd: {}\n", printable(status.error().message)),
                      LogWriter::kFarewell);
  return kBadInput;
}

}  // namespace bevloc::firmware
