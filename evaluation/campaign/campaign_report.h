// The rows of a campaign as JSON and as text.
#pragma once

#include <string>
#include <vector>

#include "evaluation/campaign/campaign.h"

namespace bevloc::evaluation {

/// A JSON array of all rows, each on its own line.
std::string to_json(const std::vector<CampaignRow>& rows, Level level);

/// One line for a person: mode, seed, and what matters.
std::string to_text(const CampaignRow& row);
std::string text_head();

/// The changes of state and reasons, one per line.
std::string timeline_of(const CampaignRow& row);

}  // namespace bevloc::evaluation
