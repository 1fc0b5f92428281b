// What every bevlocd program shares: command line, signals, memory settings and exit codes.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "firmware/config/config.h"
#include "firmware/telemetry/log_writer.h"

namespace bevloc::firmware {

/// Options of every bevlocd.
struct ProgramOptions {
  std::string config_file;
  bool check_config = false;
  std::string record;  ///< folder of the recording; empty to record as configured
  bool record_raw = false;
  bool live = false;  ///< --live: serve the live page at this machine alone
  std::optional<int> live_port;
};

/// Adds the options of every bevlocd to `app`. Parsing fills `options`, which must outlive it.
void declare_options(CLI::App& app, ProgramOptions& options);

/// Applies the options that override the configuration. Fails if --record-raw is given and there is
/// no recording.
Status override_config(const ProgramOptions& options, Config& config);

/// Returns the rig that the configuration names, as its file was when load_config() read it. Fails
/// if the file could not be read or has a mistake, and as check_shown() does.
Result<Rig> rig_of(const Config& config);

/// Installs the signal handlers. SIGTERM and SIGINT set stop_requested(). SIGHUP is logged and
/// ignored, because it must not end the localization before LOST is sent.
void handle_signals();

/// Returns true after SIGTERM or SIGINT. Logs a SIGHUP. Thread-safe.
bool stop_requested();

/// Checks the configuration and everything that it names, and prints "FILE: good" if nothing is
/// wrong (--check-config).
Status check_and_print(const ProgramOptions& options, const Config& config);

/// What a program does after its command line was parsed. `log` writes the log meanwhile.
using Run = std::function<Status(const LogWriter& log)>;

/// Handles signals, parses the command line, starts the log and calls `run`. Returns the exit code:
/// 0 on success, and 2 with one line on stderr if the command line or an input is wrong.
int run_program(CLI::App& app, int argc, char** argv, const Run& run);

}  // namespace bevloc::firmware
