// What the commands of the campaign have in common: their options, and what these name.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/result.h"
#include "evaluation/campaign/campaign.h"

namespace bevloc::evaluation {

/// What CampaignInputs::load() returns.
struct LoadedCampaign {
  Campaign campaign;
  std::vector<const Mode*> modes;
};

/// What a command line gives to a campaign.
struct CampaignInputs {
  CampaignOptions options;
  std::vector<std::string> modes;  ///< names; without names, all modes of the level
  std::string config = "config/demo.yaml";
  std::string table;  ///< measured matches; empty for the shipped ones

  /// Adds the options that the commands share. The inputs must outlive `command`.
  void declare(CLI::App& command);

  /// Loads the campaign and finds its modes. From then on only errors are logged, because runs with
  /// faults log much. `maps`: what the drives may go through, beside the map of the configuration.
  /// `out`: the file that the command writes; may be empty. Fails for seeds of training, for an
  /// unknown mode, for a table that the level does not use, for a map on which nothing can drive,
  /// if `out` is a file that is read, and as Campaign::create() does.
  Result<LoadedCampaign> load(const std::vector<std::string>& maps, const std::string& out) const;
};

}  // namespace bevloc::evaluation
