// Reads {"config": [text, ...], "rig": [text, ...]} from stdin and prints what the readers say
// about each text, in the same form: "" if they accept it. With --schema it prints both schemas
// instead.
#include <iostream>
#include <string_view>

#include <nlohmann/json.hpp>

#include "command/schema/schema_command.h"
#include "evaluation/drive/drive_config.h"
#include "pipeline/calibration/rig_yaml.h"

namespace {

std::string verdict_on_config(const std::string& text) {
  auto yaml = bevloc::YamlMap::parse(text, "test.yaml");
  if (!yaml) return yaml.error().message;
  std::optional<bevloc::evaluation::SimulationConfig> simulation;
  const auto reader = bevloc::evaluation::simulation_reader(simulation);
  bevloc::firmware::read_config(*yaml, {}, &reader);
  const bevloc::Status status = yaml->finish();
  return status ? "" : status.error().message;
}

std::string verdict_on_rig(const std::string& text) {
  const auto rig = bevloc::parse_rig(text, "rig.yaml");
  return rig ? "" : rig.error().message;
}

}  // namespace

int main(int argc, char** argv) {
  nlohmann::ordered_json output;
  if (argc > 1 && std::string_view(argv[1]) == "--schema") {
    std::optional<bevloc::evaluation::SimulationConfig> simulation;
    const auto reader = bevloc::evaluation::simulation_reader(simulation);
    output["config"] = bevloc::command::configuration_schema(&reader);
    output["vehicle"] = bevloc::command::configuration_schema(nullptr);
    output["rig"] = bevloc::command::rig_schema();
  } else {
    const auto input = nlohmann::json::parse(std::cin);
    for (const std::string text : input.at("config")) {
      output["config"].push_back(verdict_on_config(text));
    }
    for (const std::string text : input.at("rig")) output["rig"].push_back(verdict_on_rig(text));
  }
  std::cout << output.dump() << '\n';
  return 0;
}
