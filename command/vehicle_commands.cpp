#include "command/vehicle_commands.h"

#include <string>

#include "command/doctor/doctor_command.h"
#include "command/init/init_command.h"
#include "command/listen/listen_command.h"
#include "command/manual/manual_commands.h"
#include "command/schema/schema_command.h"
#include "command/status/status_command.h"
#include "command/udev/udev_rules_command.h"
#include "common/version.h"

namespace bevloc::command {

void add_vehicle_commands(CLI::App& app, CommandList& commands,
                          const firmware::SimulationReader* simulation) {
  app.set_version_flag("--version", std::string(version()));
  app.require_subcommand(1);
  commands.add_with<DoctorCommand>(simulation, app);
  commands.add_with<InitCommand>(simulation, app);
  commands.add_with<SchemaCommand>(simulation, app);
  commands.add_with<ManualCommand>(simulation, app);
  commands.add_with<UdevRulesCommand>(simulation, app);
  commands.add<StatusCommand>(app);
  commands.add<ListenCommand>(app);
  commands.add<CompletionCommand>(app);
}

}  // namespace bevloc::command
