#include "evaluation/recording/replay_setup.h"

#include <algorithm>
#include <cstdlib>

#include <spdlog/spdlog.h>

#include "common/files.h"
#include "common/sha256.h"
#include "common/version.h"
#include "evaluation/drive/drive_config.h"
#include "firmware/recording/topics.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/map_loader.h"

namespace bevloc::evaluation {
namespace {

namespace fs = std::filesystem;

/// Writes the content to a file in the scratch folder.
Result<fs::path> copy_of(const std::string& content, std::string_view name,
                         const ScratchFolder& scratch) {
  const fs::path copy = scratch.path() / name;
  if (Status written = write_file(copy, content); !written) {
    return tl::unexpected(written.error());
  }
  return copy;
}

/// A copy of the DBC file. Empty if the recording holds none, as those of old versions.
Result<fs::path> recorded_dbc(const Recording& recording, const ScratchFolder& scratch) {
  const mcap::Attachment* dbc = recording.attachment(firmware::kDbcAttachment);
  if (dbc == nullptr) return fs::path();
  return copy_of(dbc->data, firmware::kDbcAttachment, scratch);
}

/// The file where it was, if it still has this content; else a copy in the scratch folder.
Result<fs::path> file_with(const std::string& content, const fs::path& where, const char* name,
                           const ScratchFolder& scratch) {
  const auto there = read_file(where);
  if (there && *there == content) return where;
  return copy_of(content, name, scratch);
}

Result<firmware::Config> recorded_config(const Recording& recording, const ScratchFolder& scratch) {
  if (const auto damaged = recording.damaged_attachment()) {
    return fail("{}: found a damaged attachment {}, wanted a whole one; give --config",
                recording.name(), *damaged);
  }
  const mcap::Attachment* text = recording.attachment(firmware::kConfigAttachment);
  if (text == nullptr) {
    return fail("{}: found no configuration in the recording, wanted one; give --config",
                firmware::kConfigAttachment);
  }
  const fs::path original = recording.value(firmware::kConfigKey);
  const auto file = file_with(text->data, original, "configuration.yaml", scratch);
  if (!file) return tl::unexpected(file.error());
  const auto dbc = recorded_dbc(recording, scratch);
  if (!dbc) return tl::unexpected(dbc.error());
  auto config =
      load_recorded_drive_config(*file, {.folder = original.parent_path(), .dbc_file = *dbc});
  if (!config) return tl::unexpected(config.error());
  const mcap::Attachment* rig = recording.attachment(firmware::kRigAttachment);
  if (rig != nullptr) {
    const auto rig_file = file_with(rig->data, config->rig_file, "rig.yaml", scratch);
    if (!rig_file) return tl::unexpected(rig_file.error());
    config->rig_file = *rig_file;
  }
  std::error_code ignored;
  if (!fs::exists(config->model_file, ignored)) {
    config->model_file = recording.value(firmware::kModelFileKey);
  }
  return *config;
}

/// Writes the learned calibration of the recording into a file of its own, so that the replay
/// changes no file that the daemon uses.
Status restore_learned(const Recording& recording, const ScratchFolder& scratch,
                       firmware::Config& config) {
  config.learned_calibration_file.clear();
  const mcap::Attachment* learned = recording.attachment(firmware::kLearnedAttachment);
  if (learned == nullptr) return {};
  config.learned_calibration_file = scratch.path() / "learned.yaml";
  return write_file(config.learned_calibration_file, learned->data);
}

/// Removes what a replay must not do, and applies the overrides.
void prepare(const ReplayOverrides& overrides, firmware::Config& config) {
  config.record.reset();
  if (!overrides.model.empty()) config.model_file = overrides.model;
  if (config.can.secoc) {
    spdlog::warn("replay: leaves out the authentication, because a recording holds no key");
    config.can.secoc.reset();
  }
}

/// The end of the messages about positions of gpsd that are missing.
constexpr const char* kWithoutGnss =
    "no pose would be found; if the bus has positions too, give --config with a configuration "
    "without this section";

Result<HdMap> map_for(Recording& recording, const ReplayOverrides& overrides,
                      const firmware::Config& config) {
  if (!overrides.map.empty()) return load_map(overrides.map);
  auto recorded = recording.map();
  if (!recorded) return tl::unexpected(recorded.error());
  if (*recorded) return std::move(**recorded);
  const fs::path file =
      config.map_file.empty() ? fs::path(recording.value(firmware::kMapFileKey)) : config.map_file;
  if (file.empty()) {
    return fail(
        "{}: found no map, wanted a recording that holds one, or --map; {}", recording.name(),
        recording.messages(firmware::kMapTopic).empty() ? "it was cut before its first second"
                                                        : "its map was too large to be recorded");
  }
  auto map = load_map(file);
  if (!map) return map;
  const std::string checksum = fmt::format("{:08x}", map_checksum(*map));
  if (checksum != recording.value(firmware::kMapChecksumKey)) {
    spdlog::warn("{}: found a map with checksum {}, the recording was made with {}", file.string(),
                 checksum, recording.value(firmware::kMapChecksumKey));
  }
  return map;
}

void warn_of_another_model(const Recording& recording, const firmware::Config& config) {
  const auto model = read_file(config.model_file);
  const std::string recorded = recording.value(firmware::kModelChecksumKey);
  if (!model || recorded.empty() || sha256_hex(*model) == recorded) return;
  spdlog::warn("{}: found another model than the recording was made with; the poses differ",
               config.model_file.string());
}

void warn_of_another_version(const Recording& recording) {
  const std::string recorded = recording.value(firmware::kVersionKey);
  if (recorded.empty() || recorded == version()) return;
  spdlog::warn("{}: found a recording of bevloc {}, this is bevloc {}; frames and poses may differ",
               recording.name(), recorded, version());
}

}  // namespace

Result<ScratchFolder> ScratchFolder::create() {
  std::string name = (fs::temp_directory_path() / "bevloc-replay-XXXXXX").string();
  if (mkdtemp(name.data()) != nullptr) return ScratchFolder(name);
  return fail("{}: cannot make a folder ({}), wanted one for what the recording attaches",
              fs::temp_directory_path().string(), std::generic_category().message(errno));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

Result<ReplaySetup> setup_of(Recording& recording, const ReplayOverrides& overrides,
                             const ScratchFolder& scratch) {
  ReplaySetup setup;
  if (overrides.config.empty()) {
    auto config = recorded_config(recording, scratch);
    if (!config) return tl::unexpected(config.error());
    setup.config = std::move(*config);
  } else {
    auto config = load_drive_config(overrides.config);
    if (!config) return tl::unexpected(config.error());
    setup.config = *config;
  }
  if (Status status = restore_learned(recording, scratch, setup.config); !status) {
    return tl::unexpected(status.error());
  }
  prepare(overrides, setup.config);
  if (setup.config.gnss && recording.messages(firmware::kGnssTopic).empty()) {
    return fail("{}: found no positions of gpsd, wanted some because of the section gnss; {}",
                recording.name(), kWithoutGnss);
  }
  warn_of_another_version(recording);
  warn_of_another_model(recording, setup.config);
  auto rig = read_rig(setup.config.rig_file);
  if (!rig) return tl::unexpected(rig.error());
  setup.rig = *rig;
  auto map = map_for(recording, overrides, setup.config);
  if (!map) return tl::unexpected(map.error());
  setup.map = std::move(*map);
  return setup;
}

Result<ReplaySetup> setup_of(const ReplayOverrides& overrides) {
  auto config = load_drive_config(overrides.config);
  if (!config) return tl::unexpected(config.error());
  ReplaySetup setup;
  setup.config = *config;
  setup.config.learned_calibration_file.clear();
  prepare(overrides, setup.config);
  if (setup.config.gnss) {
    return fail(
        "replay: found the section gnss, wanted GNSS on the bus; a candump log has no positions of "
        "gpsd, so {}",
        kWithoutGnss);
  }
  auto rig = read_rig(setup.config.rig_file);
  if (!rig) return tl::unexpected(rig.error());
  setup.rig = *rig;
  const fs::path& file = overrides.map.empty() ? setup.config.map_file : overrides.map;
  if (file.empty()) {
    return fail("{}: found a procedural map, wanted a map file; give --map",
                overrides.config.string());
  }
  auto map = load_map(file);
  if (!map) return tl::unexpected(map.error());
  setup.map = std::move(*map);
  return setup;
}

}  // namespace bevloc::evaluation
