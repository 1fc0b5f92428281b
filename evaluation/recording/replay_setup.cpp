#include "evaluation/recording/replay_setup.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fstream>
#include <set>

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "can/bus/candump.h"
#include "common/files.h"
#include "common/sha256.h"
#include "common/version.h"
#include "drivers/camera/replay/replay_camera.h"
#include "evaluation/drive/drive_config.h"
#include "firmware/devices/can_bus.h"
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

/// Fails if the configuration takes positions from gpsd, because no recording holds them.
Status prepare(const ReplayOverrides& overrides, firmware::Config& config) {
  if (config.gnss) {
    return fail(
        "replay: found the section gnss, wanted GNSS on the bus; a recording holds no positions of "
        "gpsd, so no pose would be found; if the bus has positions too, give --config with a "
        "configuration without this section");
  }
  config.record.reset();
  if (!overrides.model.empty()) config.model_file = overrides.model;
  if (config.can.secoc) {
    spdlog::warn("replay: leaves out the authentication, because a recording holds no key");
    config.can.secoc.reset();
  }
  return {};
}

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

/// The log time of the first bus frame or image of the run. The head of the file does not count.
uint64_t first_input_ns(const Recording& recording) {
  uint64_t first = recording.end_ns();
  const auto look_at = [&](std::string_view topic) {
    const auto& places = recording.messages(topic);
    if (!places.empty()) first = std::min(first, places.front().log_time_ns);
  };
  look_at(firmware::kBusInTopic);
  look_at(firmware::kBusOutTopic);
  for (int camera = 0; camera < kCameraCount; ++camera) look_at(firmware::image_topic(camera));
  return first;
}

/// The appliance would refuse each image whose size is not that of the rig.
Status check_image_sizes(Recording& recording, const Rig& rig) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto& places = recording.messages(firmware::calibration_topic(camera));
    if (places.empty()) continue;
    const auto recorded = recording.read<foxglove::CameraCalibration>(places.front());
    if (!recorded) return tl::unexpected(recorded.error());
    const Intrinsics& lens = rig.cameras[camera].intrinsics;
    if (static_cast<int>(recorded->width()) == lens.width_px &&
        static_cast<int>(recorded->height()) == lens.height_px) {
      continue;
    }
    return fail("{}: found images of {}x{} of the camera {}, wanted {}x{} as in the rig",
                recording.name(), recorded->width(), recorded->height(), kCameraNames[camera],
                lens.width_px, lens.height_px);
  }
  return {};
}

/// The line of an entry in a log. A log can have empty lines, which are no entries.
std::string place_of_entry(const fs::path& log, size_t entry) {
  std::ifstream lines(log);
  std::string line;
  int number = 0;
  for (size_t entries = 0; entries <= entry && std::getline(lines, line); ++number) {
    if (line != "" && line != "\r") ++entries;
  }
  return fmt::format("{}:{}", log.string(), number);
}

/// Refuses a log whose clock jumps, for example from 1970 to today, because its replay would take
/// as long as the jump. Lines of several interfaces may be a little out of order.
Status check_times(const std::vector<can::CandumpEntry>& entries, const fs::path& log) {
  constexpr Duration kLongestGap = std::chrono::seconds(60);
  constexpr Duration kFarthestBack = std::chrono::seconds(1);
  for (size_t i = 1, newest = 0; i < entries.size(); ++i) {
    const Duration step = entries[i].time - entries[newest].time;
    if (step > kLongestGap) {
      return fail(
          "{}: found a time {:.1f} s after the line before, wanted at most {:g} s; the clock was "
          "set or the log was paused, so cut the log there and replay one part",
          place_of_entry(log, i), to_seconds(step), to_seconds(kLongestGap));
    }
    if (step < -kFarthestBack) {
      return fail(
          "{}: found a time {:.1f} s before that of an earlier line, wanted at most {:g} s; the "
          "clock was set back or logs were joined, so cut the log there and replay one part",
          place_of_entry(log, i), to_seconds(-step), to_seconds(kFarthestBack));
    }
    if (step > Duration::zero()) newest = i;
  }
  return {};
}

/// The interface of the vehicle's bus in a log: the configured one if the log has several. Fails if
/// the log has several others.
Result<std::string> interface_of(const std::vector<can::CandumpEntry>& entries,
                                 const std::string& configured, const fs::path& log) {
  std::set<std::string> interfaces;
  for (const can::CandumpEntry& entry : entries) interfaces.insert(entry.interface);
  if (interfaces.size() == 1) return *interfaces.begin();
  if (interfaces.contains(configured)) return configured;
  return fail("{}: found frames of {}, wanted those of can.interface ({}) or of one interface",
              log.string(), fmt::join(interfaces, ", "), configured);
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
  if (Status prepared = prepare(overrides, setup.config); !prepared) {
    return tl::unexpected(prepared.error());
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
  if (Status prepared = prepare(overrides, setup.config); !prepared) {
    return tl::unexpected(prepared.error());
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

Result<ReplayInputs> inputs_of(Recording& recording, const Rig& rig) {
  if (Status same = check_image_sizes(recording, rig); !same) return tl::unexpected(same.error());
  auto frames = played_frames(recording, firmware::kBusInTopic);
  if (!frames) return tl::unexpected(frames.error());
  const std::string text = recording.value(firmware::kStartKey);
  int64_t start_ns = 0;
  std::from_chars(text.data(), text.data() + text.size(), start_ns);
  // A later file of a ring begins in the middle of the run: at one of its bus cycles.
  constexpr Duration kCycle = std::chrono::milliseconds(10);
  const Time start{Duration(start_ns)};
  const Time first = recording.clock_time(first_input_ns(recording));
  ReplayInputs inputs;
  inputs.begin = first < start ? first : start + (first - start) / kCycle * kCycle;
  inputs.end = recording.clock_time(recording.end_ns());
  inputs.bus = std::move(*frames);
  inputs.cameras = [&recording, &rig](drivers::Clock& clock) {
    std::vector<std::unique_ptr<drivers::Camera>> cameras;
    for (int camera = 0; camera < kCameraCount; ++camera) {
      const Intrinsics& lens = rig.cameras[camera].intrinsics;
      cameras.push_back(
          std::make_unique<PlayedCamera>(recording, camera, lens.width_px, lens.height_px, clock));
    }
    return cameras;
  };
  return inputs;
}

Result<ReplayInputs> inputs_of_candump(const fs::path& log, const fs::path& images,
                                       const ReplaySetup& setup) {
  const auto entries = can::read_candump_file(log.string());
  if (!entries) return tl::unexpected(entries.error());
  if (Status status = check_times(*entries, log); !status) return tl::unexpected(status.error());
  const auto interface = interface_of(*entries, setup.config.can.interface, log);
  if (!interface) return tl::unexpected(interface.error());
  const auto accepted = firmware::appliance_options(setup.config.can).accepted_ids;
  ReplayInputs inputs;
  for (const can::CandumpEntry& entry : *entries) {
    const bool wanted = entry.kind == can::CandumpKind::kData && entry.interface == *interface &&
                        std::ranges::find(accepted, entry.frame.id) != accepted.end();
    if (wanted) inputs.bus.push_back({Time(entry.time), {entry.frame, Time(entry.time)}});
  }
  if (inputs.bus.empty()) {
    return fail(
        "{}: found none of the vehicle's messages, wanted odometry and GNSS with the "
        "identifiers of the configuration",
        log.string());
  }
  std::ranges::stable_sort(inputs.bus, {}, &PlayedFrame::delivered);
  inputs.begin = inputs.bus.front().delivered;
  inputs.end = inputs.bus.back().delivered;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto frames = drivers::load_recording(images / kCameraNames[camera]);
    if (!frames) return tl::unexpected(frames.error());
    if (frames->front().time > inputs.end || frames->back().time < inputs.begin) {
      return fail(
          "{}: found pictures from {:.1f} s to {:.1f} s, wanted times of the log, which "
          "goes from {:.1f} s to {:.1f} s",
          (images / kCameraNames[camera] / "frames.txt").string(),
          to_seconds(frames->front().time.time_since_epoch()),
          to_seconds(frames->back().time.time_since_epoch()),
          to_seconds(inputs.begin.time_since_epoch()), to_seconds(inputs.end.time_since_epoch()));
    }
    inputs.begin = std::min(inputs.begin, frames->front().time);
  }
  inputs.cameras = [images, &setup](drivers::Clock& clock) {
    std::vector<std::unique_ptr<drivers::Camera>> cameras;
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::ReplayCameraConfig played;
      played.camera = camera;
      played.directory = images / kCameraNames[camera];
      played.width_px = setup.rig.cameras[camera].intrinsics.width_px;
      played.height_px = setup.rig.cameras[camera].intrinsics.height_px;
      played.buffers = setup.config.cameras.buffers;
      cameras.push_back(std::make_unique<drivers::ReplayCamera>(played, clock));
    }
    return cameras;
  };
  return inputs;
}

}  // namespace bevloc::evaluation
