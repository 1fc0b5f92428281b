// The command bevloc of a vehicle. It contains no simulator; the program with the simulator is
// evaluation/bevloc.cpp.
#include "command/vehicle_commands.h"

int main(int argc, char** argv) {
  CLI::App app("Sets up and checks the appliance");
  bevloc::command::CommandList commands;
  bevloc::command::add_vehicle_commands(app, commands, nullptr);
  return commands.run(app, argc, argv);
}
