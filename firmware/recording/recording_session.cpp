#include "firmware/recording/recording_session.h"

#include "common/files.h"
#include "common/kernel_time.h"
#include "common/sha256.h"
#include "common/version.h"
#include "firmware/recording/messages.h"
#include "firmware/recording/recording_file.h"
#include "firmware/recording/taps.h"
#include "firmware/recording/topics.h"
#include "pipeline/map/map_checksum.h"

namespace bevloc::firmware {
namespace {

constexpr const char* kYaml = "application/yaml";

std::string absolute_name(const std::filesystem::path& path) {
  std::error_code ignored;
  return path.empty() ? "" : std::filesystem::absolute(path, ignored).lexically_normal().string();
}

/// Attaches what the appliance uses: the file as load_config() read it, or else as it is now.
void attach_file(std::string_view name, const char* media_type, const std::filesystem::path& path,
                 const Config& config, RecordingHead& head) {
  auto content = config.kept_files.bytes_of(path);
  if (!content) return;
  head.attachments.push_back({0, std::string(name), media_type, std::move(*content)});
}

std::map<std::string, std::string> metadata_of(const Config& config, const HdMap& map,
                                               bool lockstep, Time now, Duration offset) {
  const auto model = read_file(config.model_file);
  std::map<std::string, std::string> values;
  const auto set = [&values](std::string_view key, std::string value) {
    values.emplace(key, std::move(value));
  };
  set(kVersionKey, std::string(version()));
  set(kClockOffsetKey, std::to_string(offset.count()));
  set(kStartKey, std::to_string(now.time_since_epoch().count()));
  set(kLockstepKey, lockstep ? "yes" : "no");
  set(kConfigKey, absolute_name(config.file));
  set(kMapFileKey, absolute_name(config.map_file));
  set(kModelFileKey, absolute_name(config.model_file));
  set(kMapChecksumKey, fmt::format("{:08x}", map_checksum(map)));
  set(kModelChecksumKey, model ? sha256_hex(*model) : "");
  return values;
}

template <typename Message>
void add_message(std::string topic, Message message, RecordingHead& head) {
  head.messages.push_back({std::move(topic), std::make_shared<Message>(std::move(message))});
}

}  // namespace

Result<std::unique_ptr<Recorder>> open_recorder(const Config& config, const Rig& rig,
                                                const HdMap& map, bool lockstep, Time now) {
  if (!config.record) return nullptr;
  const Duration offset = read_clock(CLOCK_REALTIME) - now.time_since_epoch();
  RecordingHead head;
  head.metadata = metadata_of(config, map, lockstep, now, offset);
  attach_file(kConfigAttachment, kYaml, config.file, config, head);
  attach_file(kRigAttachment, kYaml, config.rig_file, config, head);
  if (config.can.vehicle)
    attach_file(kDbcAttachment, "text/plain", config.can.dbc_file, config, head);
  if (!config.learned_calibration_file.empty()) {
    attach_file(kLearnedAttachment, kYaml, config.learned_calibration_file, config, head);
  }
  add_message(std::string(kMapTopic), map_message(map), head);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    add_message(calibration_topic(camera), calibration_message(rig.cameras[camera], camera), head);
  }
  return Recorder::open(*config.record, std::move(head), offset, now);
}

void tap(Hardware& hardware, Recorder& recorder) {
  for (auto& camera : hardware.cameras) {
    camera = std::make_unique<RecordedCamera>(std::move(camera), recorder, *hardware.clock);
  }
  hardware.bus = std::make_unique<RecordedBus>(std::move(hardware.bus), recorder, *hardware.clock);
}

void watch(Appliance& appliance, Recorder& recorder) {
  const drivers::Clock& clock = appliance.clock();
  appliance.vision().observe([&recorder, &clock](const VisionSnapshot& snapshot) {
    recorder.note_match(snapshot, clock.now());
  });
  appliance.estimation().observe_reports(
      [&recorder](const can::PoseReport& report) { recorder.note_solution(report); });
  if (GnssStage* gnss = appliance.gnss(); gnss != nullptr) {
    gnss->observe([&recorder, &clock](const drivers::GnssFix& fix, const drivers::FixTime& time) {
      recorder.note_fix({clock.now(), fix, time});
    });
  }
  recorder.count_with([&appliance] { return take_snapshot(appliance, {}); });
}

std::optional<RecordingSnapshot> totals_of(const Config& config, const Recorder* recorder) {
  if (!config.record) return std::nullopt;
  return recorder != nullptr ? recorder->totals() : RecordingSnapshot{.failed = true};
}

}  // namespace bevloc::firmware
