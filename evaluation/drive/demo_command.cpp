#include "evaluation/drive/demo_command.h"

#include "common/replace_process.h"
#include "common/shipped_file.h"

namespace bevloc::evaluation {
namespace {

constexpr const char* kConfig = "config/demo.yaml";

}  // namespace

void DemoCommand::declare(CLI::App& app) {
  auto* demo = app.add_subcommand("demo", "Drive through a simulated town, without any hardware");
  demo->prefix_command();
  demo->footer(
      "All options are those of bevlocd, such as --fast, --duration, --seed and --out.\n"
      "Examples:\n"
      "  bevloc demo --fast --duration 20\n"
      "  bevloc demo --seed 5 --out drive");
  demo->callback([this, demo] { rest_ = demo->remaining(); });
}

Status DemoCommand::run() const {
  const auto config = shipped_file(kConfig);
  if (!config) return fail("{}: found no such file, wanted the demo's configuration", kConfig);
  std::vector<std::string> arguments{"--config", config->string()};
  arguments.insert(arguments.end(), rest_.begin(), rest_.end());
  return replace_process(folder_of_this_program() / "bevlocd", std::move(arguments));
}

}  // namespace bevloc::evaluation
