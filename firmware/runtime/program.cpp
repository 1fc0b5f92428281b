#include "firmware/runtime/program.h"

#include <atomic>
#include <csignal>

#include <malloc.h>

#include "common/version.h"

namespace bevloc::firmware {
namespace {

constexpr int kBadInput = 2;

std::atomic<bool> g_stop_requested{false};

void request_stop(int) {
  g_stop_requested = true;
}

}  // namespace

void declare_options(CLI::App& app, ProgramOptions& options) {
  app.set_version_flag("--version", std::string(version()));
  app.add_option("--config", options.config_file, "Configuration file")->required();
  app.add_flag("--check-config", options.check_config,
               "Check the configuration and everything that it names, then exit");
}

bool stop_requested() {
  return g_stop_requested;
}

Status check_and_print(const ProgramOptions& options, const Config& config) {
  if (Status status = check_config(config); !status) return status;
  fmt::print("{}: good\n", options.config_file);
  return {};
}

int run_program(CLI::App& app, int argc, char** argv, const std::function<Status()>& run) {
  // One heap arena for all threads. Threads allocate at their start and hardly ever later, so
  // separate arenas would only keep unused memory.
  mallopt(M_ARENA_MAX, 1);
  std::signal(SIGTERM, request_stop);
  std::signal(SIGINT, request_stop);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  const Status status = run();
  if (status) return 0;
  fmt::print(stderr, "bevlocd: {}\n", status.error().message);
  return kBadInput;
}

}  // namespace bevloc::firmware
