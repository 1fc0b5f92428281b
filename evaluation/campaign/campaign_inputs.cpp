#include "evaluation/campaign/campaign_inputs.h"

#include <utility>

#include <spdlog/spdlog.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "common/shipped_file.h"
#include "evaluation/choice_option.h"
#include "evaluation/drivable_map.h"
#include "evaluation/town_seeds.h"
#include "firmware/config/files_of_config.h"

namespace bevloc::evaluation {
namespace {

constexpr const char* kShippedTable = "evaluation/campaign/matches.csv";

}  // namespace

void CampaignInputs::declare(CLI::App& command) {
  add_choice(command, "--level", options.level,
             {{"stage", Level::kStage}, {"pictures", Level::kPictures}},
             "stage: the estimation stage with a matcher whose errors were measured; pictures: the "
             "whole appliance");
  command.add_option("--first-seed", options.first_seed, "The first seed")
      ->check(whole_number())
      ->capture_default_str();
  command.add_option("--duration", options.duration_s, "Length of each drive, seconds")
      ->check(number_between(5.0, 1e6))
      ->capture_default_str();
  command.add_option("--config", config, "Configuration with mock cameras")->capture_default_str();
  command.add_option("--matches", table, "Measured matches for --level stage")
      ->check(is_name_of("a file of `bevloc tune matches`"))
      ->default_str(kShippedTable);
}

Result<LoadedCampaign> CampaignInputs::load(const std::vector<std::string>& maps,
                                            const std::string& out) const {
  if (Status towns = check_town_seeds("--first-seed", options.first_seed, options.seeds); !towns) {
    return tl::unexpected(towns.error());
  }
  if (options.level == Level::kPictures && !table.empty()) {
    return fail(
        "--matches: found {} with --level pictures, wanted --level stage, because pictures need no "
        "measured matches",
        table);
  }
  spdlog::set_level(spdlog::level::err);
  auto chosen = modes_named(modes, options.level);
  if (!chosen) return tl::unexpected(chosen.error());
  if (Status drivable = check_drivable(maps); !drivable) return tl::unexpected(drivable.error());
  const std::string used_table = given_or_shipped(table.empty() ? kShippedTable : table);
  auto campaign = Campaign::create(config, used_table, options);
  if (!campaign) return tl::unexpected(campaign.error());
  std::vector<std::filesystem::path> inputs = files_of(campaign->config());
  inputs.insert(inputs.end(), maps.begin(), maps.end());
  inputs.emplace_back(used_table);
  if (Status other = check_output(out, inputs); !other) return tl::unexpected(other.error());
  return LoadedCampaign{std::move(*campaign), std::move(*chosen)};
}

}  // namespace bevloc::evaluation
