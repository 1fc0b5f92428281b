#include "command/schema/schema_command.h"

#include <fmt/format.h>

#include "command/schema/json_schema.h"
#include "command/schema/page_texts.h"
#include "pipeline/calibration/rig_keys.h"

namespace bevloc::command {

nlohmann::ordered_json configuration_schema(const firmware::SimulationReader* simulation) {
  const PageTexts page(configuration_page());
  const auto describe = [&page](const std::string& path) {
    if (parent_of(path).empty()) return page.introduction(path);
    return page.meaning(path);
  };
  const auto read = [simulation](YamlMap& yaml) { firmware::read_config(yaml, {}, simulation); };
  return schema_of(read, {"Configuration of bevlocd", describe});
}

nlohmann::ordered_json rig_schema() {
  const PageTexts page(bring_your_own_page());
  const auto describe = [&page](const std::string& path) { return page.meaning(path); };
  const auto read = [](YamlMap& yaml) {
    RigKeys keys;
    read_rig_keys(yaml, keys);
  };
  return schema_of(read, {"Rig file of bevloc: calibration of the six cameras", describe});
}

void SchemaCommand::declare(CLI::App& app) {
  auto* schema = app.add_subcommand(
      "schema", "Print the JSON Schema of the configuration, with which editors complete it");
  schema->add_flag("--rig", rig_, "Print the schema of rig files instead");
  schema->footer(
      "Examples:\n"
      "  bevloc schema > bevlocd.schema.json\n"
      "  bevloc schema --rig > rig.schema.json");
}

Status SchemaCommand::run() const {
  fmt::print("{}\n", (rig_ ? rig_schema() : configuration_schema(simulation_)).dump(2));
  return {};
}

}  // namespace bevloc::command
