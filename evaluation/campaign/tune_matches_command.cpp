#include "evaluation/campaign/tune_matches_command.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/campaign/campaign.h"
#include "evaluation/campaign/match_recorder.h"
#include "evaluation/drivable_map.h"
#include "evaluation/map_turns.h"
#include "evaluation/progress_bar.h"
#include "evaluation/town_seeds.h"
#include "firmware/config/files_of_config.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::evaluation {

void TuneMatchesCommand::declare(CLI::App& tune) {
  auto* matches = tune.add_subcommand(
      "matches", "Measure matches on simulated pictures, for `bevloc campaign --level stage`");
  matches->add_option("--config", config_, "Configuration with mock cameras")
      ->capture_default_str();
  matches->add_option("--drives", drives_, "Number of drives")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  matches->add_option("--first-seed", first_seed_, "Seed of the first drive")
      ->check(whole_number())
      ->capture_default_str();
  matches->add_option("--duration", duration_s_, "Length of each drive, seconds")
      ->check(number_between(1.0, 3600.0))
      ->capture_default_str();
  matches->add_option("--map", maps_, "Every second drive goes through one of these maps, in turn");
  matches->add_option("--csv", csv_file_, "File to write")->required()->check(output_file());
  matches->footer(
      "Examples:\n"
      "  bevloc tune matches --drives 10 --first-seed 2000 --csv matches.csv");
}

Status TuneMatchesCommand::run() const {
  if (Status towns = check_town_seeds("--first-seed", first_seed_, drives_); !towns) return towns;
  if (Status driven = check_map_turns(maps_, "--drives", drives_); !driven) return driven;
  spdlog::set_level(spdlog::level::warn);
  if (Status drivable = check_drivable(maps_); !drivable) return drivable;
  auto config = load_faultless_config(config_, "matches are measured without faults");
  if (!config) return tl::unexpected(config.error());
  std::vector<std::filesystem::path> inputs = files_of(*config);
  inputs.insert(inputs.end(), maps_.begin(), maps_.end());
  if (Status other = check_output(csv_file_, inputs); !other) return other;
  const auto rig = read_rig(config->rig_file);
  if (!rig) return tl::unexpected(rig.error());
  config->simulation->duration_s = duration_s_;
  MatchTable table;
  const auto seconds = static_cast<int>(duration_s_);
  for (int drive = 0; drive < drives_; ++drive) {
    const DriveConfig driven = config_of_drive(*config, first_seed_ + static_cast<uint64_t>(drive),
                                               map_of_drive(maps_, drive));
    auto places = record_matches(driven, *rig, drive, [&](double time_s) {
      show_progress(drive * seconds + static_cast<int>(time_s) + 1, drives_ * seconds,
                    "seconds of driving");
    });
    if (!places) return tl::unexpected(places.error());
    std::ranges::move(*places, std::back_inserter(table.places));
    if (Status status = write_option_file(csv_file_, to_csv(table)); !status) return status;
  }
  return {};
}

}  // namespace bevloc::evaluation
