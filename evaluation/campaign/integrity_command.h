// `bevloc eval integrity`: judges the protection levels over drives and faults.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/campaign/campaign_inputs.h"

namespace bevloc::evaluation {

class IntegrityCommand {
 public:
  void declare(CLI::App& eval);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.

 private:
  CampaignInputs inputs_;
  std::vector<std::string> maps_;
  std::string json_file_;
};

}  // namespace bevloc::evaluation
