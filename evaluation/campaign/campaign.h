// Runs modes x seeds of the campaign and collects their outcomes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "drivers/mock/picture_cache.h"
#include "evaluation/campaign/match_table.h"
#include "evaluation/campaign/modes/mode.h"
#include "evaluation/campaign/run_outcome.h"
#include "evaluation/campaign/stage_run.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::evaluation {

struct CampaignOptions {
  Level level = Level::kStage;
  uint64_t first_seed = 401;
  int seeds = 1;
  double duration_s = 60.0;
  std::string map;  ///< drive through this map instead of procedural towns
};

/// Loads the configuration of drives that have no fault of their own. `why_no_faults` completes
/// "found simulation.faults, wanted none, because". Fails unless the cameras are mock.
Result<DriveConfig> load_faultless_config(const std::string& file, std::string_view why_no_faults);

/// Returns the configuration of one drive: with this seed, and through `map` if it is not empty.
/// Otherwise the drive goes through the map of `config`, or through the procedural town of the seed
/// if `config` names no map.
DriveConfig config_of_drive(DriveConfig config, uint64_t seed, const std::string& map);

struct CampaignRow {
  const Mode* mode = nullptr;
  uint64_t seed = 0;
  bool fault_ends = false;  ///< whether the fault ends within the drive
  RunOutcome outcome;
};

/// What every run of a campaign needs, loaded once.
class Campaign {
 public:
  /// Fails if the configuration (which must have mock cameras), the rig or the table cannot be
  /// read. The table is needed on the stage level only.
  static Result<Campaign> create(const std::string& config_file, const std::string& table_file,
                                 const CampaignOptions& options);

  /// What all drives have in common. Their towns, maps and faults differ.
  const DriveConfig& config() const { return config_; }

  /// One run, through the map that config_of_drive() chooses. Every cycle goes to `sink`.
  /// `pictures`: the cache that runs of the same seed and map share; null without a cache.
  Status drive(const Mode& mode, uint64_t seed, const std::string& map, const CycleSink& sink,
               const std::shared_ptr<drivers::PictureCache>& pictures = nullptr) const;

  /// All modes of one seed after another, so that they share its pictures. `done` is called after
  /// each row. Fails if a world cannot be made.
  Status run(const std::vector<const Mode*>& modes,
             const std::function<void(const CampaignRow&)>& done) const;

 private:
  Campaign(DriveConfig config, Rig rig, const CampaignOptions& options)
      : config_(std::move(config)), rig_(std::move(rig)), options_(options) {}

  DriveConfig config_;
  Rig rig_;
  CampaignOptions options_;
  MatchTable table_;
};

}  // namespace bevloc::evaluation
