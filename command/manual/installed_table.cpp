#include "command/manual/installed_table.h"

#include <algorithm>

#include "command/vehicle_commands.h"

namespace bevloc::command {
namespace {

bool is_beside_vehicle_program(const std::filesystem::path& folder) {
  std::error_code error;
  return folder.filename() == "bevloc-sim" &&
         std::filesystem::exists(folder.parent_path().parent_path() / "bin/bevloc", error);
}

}  // namespace

CommandEntry installed_table(const CLI::App& app, const std::filesystem::path& folder) {
  CommandEntry table = table_of(app);
  if (!is_beside_vehicle_program(folder)) return table;
  CLI::App vehicle;
  CommandList commands;
  add_vehicle_commands(vehicle, commands, nullptr);
  for (const CommandEntry& own : table_of(vehicle).commands) {
    const auto entry = std::ranges::find(table.commands, own.name, &CommandEntry::name);
    if (entry != table.commands.end()) *entry = own;
  }
  return table;
}

}  // namespace bevloc::command
