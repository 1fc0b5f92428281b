// `bevloc schema`: the JSON Schema of the configuration and of rig files.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "common/result.h"
#include "firmware/config/config.h"

namespace bevloc::command {

/// Returns the schema of the configuration. If `simulation` is null, the schema does not have the
/// word for mock cameras.
nlohmann::ordered_json configuration_schema(const firmware::SimulationReader* simulation);
nlohmann::ordered_json rig_schema();

class SchemaCommand {
 public:
  explicit SchemaCommand(const firmware::SimulationReader* simulation) : simulation_(simulation) {}

  void declare(CLI::App& app);
  Status run() const;

 private:
  const firmware::SimulationReader* simulation_;
  bool rig_ = false;
};

}  // namespace bevloc::command
