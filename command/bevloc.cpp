// The command bevloc of a vehicle. It contains no simulator. The program with the simulator is
// evaluation/bevloc.cpp (package bevloc-sim). If it is installed, this program passes on to it the
// commands that this program lacks, and `completion`, which must know the commands of both
// programs.
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "command/vehicle_commands.h"
#include "common/option_checks.h"
#include "common/replace_process.h"

namespace {

/// The program with the simulator, relative to the folder of this one.
constexpr const char* kSimulatorProgram = "../libexec/bevloc-sim/bevloc";

bool is_installed(const std::filesystem::path& program) {
  return access(program.c_str(), X_OK) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Sets up and checks the appliance");
  app.footer("The package bevloc-sim adds commands that simulate, evaluate and draw.");
  bevloc::command::CommandList commands;
  bevloc::command::add_vehicle_commands(app, commands, nullptr);
  const auto simulator = bevloc::folder_of_this_program() / kSimulatorProgram;
  const bool names_command = argc >= 2 && argv[1][0] != '-';
  const bool is_own = argc < 2 || (names_command && bevloc::command::has_command(app, argv[1]));
  const bool completes = names_command && argv[1] == std::string_view("completion");
  if ((!is_own || completes) && is_installed(simulator)) {
    const auto failed = bevloc::replace_process(simulator, {argv + 1, argv + argc});
    std::fprintf(stderr, "bevloc: %s\n", failed.error().message.c_str());
    return bevloc::kBadInput;
  }
  if (names_command && !is_own)
    std::fputs("bevloc: further commands are in the package bevloc-sim\n", stderr);
  return commands.run(app, argc, argv);
}
