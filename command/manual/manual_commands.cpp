#include "command/manual/manual_commands.h"

#include <fmt/format.h>

#include "command/manual/completion.h"
#include "command/manual/installed_table.h"
#include "command/manual/man_page.h"
#include "command/manual/option_table.h"
#include "command/schema/schema_command.h"
#include "common/files.h"
#include "common/replace_process.h"
#include "firmware/daemon/program.h"

namespace bevloc::command {
namespace {

/// Returns the options that every bevlocd has.
CommandEntry daemon_table() {
  CLI::App app("Localizes a vehicle in its HD map");
  firmware::ProgramOptions options;
  firmware::declare_options(app, options);
  return table_of(app);
}

}  // namespace

void ManualCommand::declare(CLI::App& app) {
  app_ = &app;
  auto* manual =
      app.add_subcommand("manual", "Write the manual pages bevloc.1, bevlocd.8 and bevloc.yaml.5");
  manual->add_option("--out", folder_, "Folder for the pages")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  manual->footer("Examples:\n  bevloc manual --out . && man ./bevloc.1");
}

Status ManualCommand::run() const {
  const bool simulates = simulation_ != nullptr;
  std::vector<std::string> see_also{"bevlocd(8)", "bevloc.yaml(5)"};
  if (!simulates) see_also.emplace_back("bevloc-sim(1)");
  const std::string program = man_page_of_program(
      {.name = "bevloc",
       .section = 1,
       .what = simulates ? "sets up, checks and evaluates bevloc" : "sets up and checks bevloc",
       .see_also = see_also,
       .exit_codes = "0  good\n1  what was judged is bad\n2  wrong use or input"},
      table_of(*app_));
  const std::string daemon = man_page_of_program(
      {.name = "bevlocd",
       .section = 8,
       .what = "localizes a vehicle in its HD map",
       .see_also = {"bevloc(1)", "bevloc.yaml(5)"},
       .exit_codes = "0  it was told to end, or the simulated drive is over\n"
                     "0  with --check-config: it found no mistake\n"
                     "2  wrong use or input\n"
                     "3  it was told to end, or the ignition went off, and a thread hung"},
      daemon_table());
  const std::string configuration = man_page_of_schema({.name = "bevloc.yaml",
                                                        .section = 5,
                                                        .what = "configuration of bevlocd",
                                                        .see_also = {"bevlocd(8)", "bevloc(1)"}},
                                                       configuration_schema(simulation_));
  const std::filesystem::path folder = folder_;
  if (Status status = write_file(folder / "bevloc.1", program); !status) return status;
  if (Status status = write_file(folder / "bevlocd.8", daemon); !status) return status;
  return write_file(folder / "bevloc.yaml.5", configuration);
}

void CompletionCommand::declare(CLI::App& app) {
  app_ = &app;
  auto* completion =
      app.add_subcommand("completion", "Print a script with which the shell completes commands");
  completion->add_option("shell", shell_, "The shell")
      ->check(CLI::IsMember({"bash", "zsh"}))
      ->required();
  completion->footer(
      "Examples:\n"
      "  source <(bevloc completion bash)\n"
      "  bevloc completion zsh > ~/.zfunc/_bevloc");
}

Status CompletionCommand::run() const {
  const auto write = shell_ == "zsh" ? zsh_completion : bash_completion;
  const CommandEntry program = installed_table(*app_, folder_of_this_program());
  fmt::print("{}{}", write("bevloc", program), write("bevlocd", daemon_table()));
  return {};
}

}  // namespace bevloc::command
