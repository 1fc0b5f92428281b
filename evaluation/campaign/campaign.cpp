#include "evaluation/campaign/campaign.h"

#include <utility>

#include "common/shipped_file.h"
#include "evaluation/campaign/pictures_run.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::evaluation {
namespace {

std::vector<sim::Fault> timed(std::vector<sim::Fault> faults, const FaultTime& time) {
  for (sim::Fault& fault : faults) {
    fault.from_s = time.from_s;
    fault.until_s = time.until_s;
  }
  return faults;
}

/// The pace of a mode whose times begin at `from_s`.
sim::Pace later(std::vector<sim::PacePoint> points, double from_s) {
  for (sim::PacePoint& point : points) point.at_s += from_s;
  return sim::Pace(std::move(points));
}

}  // namespace

Result<DriveConfig> load_faultless_config(const std::string& file, std::string_view why_no_faults) {
  auto config = load_drive_config(given_or_shipped(file));
  if (!config) return config;
  if (!config->simulation) {
    return fail("{}: found cameras that are not mock, wanted mock ones", file);
  }
  if (!config->simulation->faults.empty()) {
    return fail("{}: found simulation.faults, wanted none, because {}", file, why_no_faults);
  }
  return config;
}

DriveConfig config_of_drive(DriveConfig config, uint64_t seed, const std::string& map) {
  config.simulation->seed = seed;
  if (!map.empty()) config.map_file = map;
  config.simulation->town_seed.reset();
  if (config.map_file.empty()) config.simulation->town_seed = seed;
  return config;
}

Result<Campaign> Campaign::create(const std::string& config_file, const std::string& table_file,
                                  const CampaignOptions& options) {
  auto config = load_faultless_config(config_file, "each mode has its own");
  if (!config) return tl::unexpected(config.error());
  auto rig = read_rig(config->rig_file);
  if (!rig) return tl::unexpected(rig.error());
  config->simulation->duration_s = options.duration_s;
  // No drive may know what another one learned.
  config->learned_calibration_file.clear();
  Campaign campaign(std::move(*config), std::move(*rig), options);
  if (options.level == Level::kStage) {
    auto table = read_match_table(given_or_shipped(table_file));
    if (!table) return tl::unexpected(table.error());
    campaign.table_ = std::move(*table);
  }
  return campaign;
}

Status Campaign::drive(const Mode& mode, uint64_t seed, const std::string& map,
                       const CycleSink& sink,
                       const std::shared_ptr<drivers::PictureCache>& pictures) const {
  DriveConfig config = config_of_drive(config_, seed, map);
  const FaultTime time = mode.time_in(options_.duration_s);
  config.simulation->faults = timed(mode.faults, time);
  if (!mode.pace.empty()) config.simulation->pace = later(mode.pace, time.from_s);
  return options_.level == Level::kStage ? run_stage(config, mode, table_, sink)
                                         : run_pictures(config, rig_, pictures, sink);
}

Status Campaign::run(const std::vector<const Mode*>& modes,
                     const std::function<void(const CampaignRow&)>& done) const {
  for (int k = 0; k < options_.seeds; ++k) {
    const uint64_t seed = options_.first_seed + static_cast<uint64_t>(k);
    // The modes share pictures, because most faults do not change what the cameras see.
    std::shared_ptr<drivers::PictureCache> pictures;
    if (modes.size() > 1) pictures = std::make_shared<drivers::PictureCache>();
    for (const Mode* mode : modes) {
      const FaultTime time = mode->time_in(options_.duration_s);
      RunJudge judge(time, mode->named_by);
      const Status status = drive(
          *mode, seed, options_.map, [&judge](const JudgedCycle& cycle) { judge.add(cycle); },
          pictures);
      if (!status) return status;
      done({mode, seed, time.until_s < options_.duration_s, judge.outcome()});
    }
  }
  return {};
}

}  // namespace bevloc::evaluation
