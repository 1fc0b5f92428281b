// Runs one mode of the campaign for the tests.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "evaluation/campaign/campaign.h"

namespace bevloc::evaluation {

inline RunOutcome run_mode(const std::string& name, const CampaignOptions& options) {
  const auto campaign =
      Campaign::create(BEVLOC_SOURCE_DIR "/config/demo.yaml",
                       BEVLOC_SOURCE_DIR "/evaluation/campaign/matches.csv", options);
  EXPECT_TRUE(campaign) << campaign.error().message;
  const auto modes = modes_named({name}, options.level);
  EXPECT_TRUE(modes) << modes.error().message;
  RunOutcome outcome;
  const Status status =
      campaign->run(*modes, [&outcome](const CampaignRow& row) { outcome = row.outcome; });
  EXPECT_TRUE(status) << status.error().message;
  return outcome;
}

}  // namespace bevloc::evaluation
