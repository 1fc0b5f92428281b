#include "evaluation/drive/demo_command.h"

#include "common/replace_process.h"

namespace bevloc::evaluation {

Result<std::filesystem::path> demo_config(const std::filesystem::path& folder) {
  const auto installed = (folder / "../../share/bevloc/config/demo.yaml").lexically_normal();
  const auto in_tree = (folder / "../../../config/demo.yaml").lexically_normal();
  for (const auto& file : {installed, in_tree}) {
    if (std::filesystem::exists(file)) return file;
  }
  return fail("{}: found no configuration of the demo, wanted this file or {}", installed.string(),
              in_tree.string());
}

void DemoCommand::declare(CLI::App& app) {
  auto* demo = app.add_subcommand("demo", "Drive through a simulated town, without any hardware");
  demo->prefix_command();
  demo->footer(
      "All options are those of bevlocd, such as --fast, --duration, --seed and --out.\n"
      "Examples:\n"
      "  bevloc demo --fast --duration 20\n"
      "  bevloc demo --seed 5 --out drive");
  demo->callback([this, demo] {
    chosen_ = true;
    rest_ = demo->remaining();
  });
}

Status DemoCommand::run() const {
  const auto folder = folder_of_this_program();
  const auto config = demo_config(folder);
  if (!config) return tl::unexpected(config.error());
  std::vector<std::string> arguments{"--config", config->string()};
  arguments.insert(arguments.end(), rest_.begin(), rest_.end());
  return replace_process(folder / "bevlocd", std::move(arguments));
}

}  // namespace bevloc::evaluation
