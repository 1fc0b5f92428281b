// `bevloc eval integrity`: judges the protection levels over drives and faults.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/campaign/campaign.h"

namespace bevloc::evaluation {

class IntegrityCommand {
 public:
  void declare(CLI::App& eval);

  /// Does what the parsed command line asks for.
  Status run() const;

  /// Whether the parsed command line names this command.
  bool chosen() const { return chosen_; }

 private:
  bool chosen_ = false;
  std::string config_ = "config/demo.yaml";
  std::string table_ = "evaluation/campaign/matches.csv";
  std::vector<std::string> modes_;
  std::vector<std::string> maps_;
  CampaignOptions options_;
  std::string json_file_;
};

}  // namespace bevloc::evaluation
