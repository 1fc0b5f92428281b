// Runs modes of the campaign for the tests.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "evaluation/campaign/campaign.h"

namespace bevloc::evaluation {

/// Runs all modes in one campaign, in which they share pictures. Returns each mode's outcome.
inline std::map<std::string, RunOutcome> run_modes(const std::vector<std::string>& names,
                                                   const CampaignOptions& options) {
  const auto campaign =
      Campaign::create(BEVLOC_SOURCE_DIR "/config/demo.yaml",
                       BEVLOC_SOURCE_DIR "/evaluation/campaign/matches.csv", options);
  EXPECT_TRUE(campaign) << campaign.error().message;
  const auto modes = modes_named(names, options.level);
  EXPECT_TRUE(modes) << modes.error().message;
  std::map<std::string, RunOutcome> outcomes;
  const Status status = campaign->run(*modes, [&outcomes](const CampaignRow& row) {
    outcomes[std::string(row.mode->name)] = row.outcome;
  });
  EXPECT_TRUE(status) << status.error().message;
  return outcomes;
}

inline RunOutcome run_mode(const std::string& name, const CampaignOptions& options) {
  return run_modes({name}, options)[name];
}

}  // namespace bevloc::evaluation
