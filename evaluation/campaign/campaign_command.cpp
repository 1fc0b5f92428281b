#include "evaluation/campaign/campaign_command.h"

#include <cstdio>
#include <vector>

#include <fmt/format.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/campaign/campaign_report.h"

namespace bevloc::evaluation {

void CampaignCommand::declare(CLI::App& app) {
  auto* campaign = app.add_subcommand(
      "campaign", "Run failure modes on simulated drives: is a wrong pose ever sent as valid?");
  campaign->add_option("--modes", inputs_.modes,
                       "Names of modes (see --list); default: all of the level");
  campaign->add_option("--seeds", inputs_.options.seeds, "Number of seeds, each with its own town")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  inputs_.declare(*campaign);
  campaign->add_option("--map", inputs_.options.map, "Drive through this map instead of towns")
      ->check(is_name_of("a map"));
  campaign->add_option("--json", json_file_, "Write the rows as JSON to this file")
      ->check(output_file());
  campaign->add_flag("--timeline", timeline_, "Print all changes of state and reasons");
  campaign->add_flag("--list", list_, "Print all modes and end");
  campaign->footer(
      "Examples:\n"
      "  bevloc campaign --list\n"
      "  bevloc campaign --modes odometry-spin --timeline\n"
      "  bevloc campaign --seeds 20 --json campaign.json");
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
  std::vector<std::string> maps;
  if (!inputs_.options.map.empty()) maps.push_back(inputs_.options.map);
  const auto loaded = inputs_.load(maps, json_file_);
  if (!loaded) return tl::unexpected(loaded.error());
  fmt::print("{}", text_head());
  std::vector<CampaignRow> rows;
  const Status status = loaded->campaign.run(loaded->modes, [&](const CampaignRow& row) {
    rows.push_back(row);
    fmt::print("{}", to_text(row));
    if (timeline_) fmt::print("{}", timeline_of(row));
    std::fflush(stdout);
  });
  if (!status) return status;
  return write_option_file(json_file_, to_json(rows, inputs_.options.level));
}

}  // namespace bevloc::evaluation
