#include "evaluation/campaign/campaign_command.h"

#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/option_checks.h"
#include "evaluation/campaign/campaign_report.h"
#include "evaluation/choice_option.h"
#include "evaluation/command_output.h"
#include "evaluation/town_seeds.h"

namespace bevloc::evaluation {

void CampaignCommand::declare(CLI::App& app) {
  auto* campaign = app.add_subcommand(
      "campaign", "Run failure modes on simulated drives: is a wrong pose ever sent as valid?");
  add_choice(*campaign, "--level", options_.level,
             {{"stage", Level::kStage}, {"pictures", Level::kPictures}},
             "stage: the estimation stage with a matcher whose errors were measured; pictures: the "
             "whole appliance");
  campaign->add_option("--modes", modes_, "Names of modes (--list); without: all of the level");
  campaign->add_option("--seeds", options_.seeds, "Number of seeds, each with its own town")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  campaign->add_option("--first-seed", options_.first_seed, "The first seed")
      ->check(whole_number())
      ->capture_default_str();
  campaign->add_option("--duration", options_.duration_s, "Length of each drive, seconds")
      ->check(number_between(5.0, 1e6))
      ->capture_default_str();
  campaign->add_option("--map", options_.map, "Drive through this map instead of towns")
      ->check(name_of("a map"));
  campaign->add_option("--config", config_, "Configuration with mock cameras")
      ->capture_default_str();
  campaign->add_option("--matches", table_, "Measured matches for --level stage")
      ->capture_default_str();
  campaign->add_option("--json", json_file_, "Write the rows as JSON to this file")
      ->check(output_file());
  campaign->add_flag("--timeline", timeline_, "Print all changes of state and reasons");
  campaign->add_flag("--list", list_, "Print all modes and end");
  campaign->footer(
      "Examples:\n"
      "  bevloc campaign --list\n"
      "  bevloc campaign --modes odometry-spin --timeline\n"
      "  bevloc campaign --seeds 20 --json campaign.json");
  campaign->callback([this] { chosen_ = true; });
}

Status CampaignCommand::list() const {
  for (const Mode& mode : all_modes()) {
    fmt::print("{:26} {:8} {:8} {}\n", mode.name, mode.on_stage ? "stage" : "",
               mode.on_pictures ? "pictures" : "", mode.what);
  }
  return {};
}

Status CampaignCommand::run() const {
  if (list_) return list();
  if (Status towns = check_town_seeds("--first-seed", options_.first_seed, options_.seeds);
      !towns) {
    return towns;
  }
  spdlog::set_level(spdlog::level::err);
  const auto modes = modes_named(modes_, options_.level);
  if (!modes) return tl::unexpected(modes.error());
  const auto campaign = Campaign::create(config_, table_, options_);
  if (!campaign) return tl::unexpected(campaign.error());
  fmt::print("{}", text_head());
  std::vector<CampaignRow> rows;
  const Status status = campaign->run(*modes, [&](const CampaignRow& row) {
    rows.push_back(row);
    fmt::print("{}", to_text(row));
    if (timeline_) fmt::print("{}", timeline_of(row));
    std::fflush(stdout);
  });
  if (!status) return status;
  return write_file(to_json(rows, options_.level), json_file_);
}

}  // namespace bevloc::evaluation
