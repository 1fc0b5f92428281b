#include "firmware/runtime/appliance.h"

#include <spdlog/spdlog.h>

#include "can/secoc/secoc_files.h"
#include "firmware/config/config_key.h"
#include "firmware/config/localizer_options.h"
#include "firmware/devices/can_bus.h"
#include "firmware/runtime/identity.h"
#include "pipeline/online_calibration/calibration_file.h"

namespace bevloc::firmware {
namespace {

/// Gives the localizer the calibration errors that an earlier drive learned. If the file cannot be
/// used, the daemon starts all the same, because this drive learns the errors again.
void restore_calibration(const Config& config, const Rig& rig, Localizer& localizer) {
  if (!config.online_calibration.enabled) return;
  const std::filesystem::path& file = config.learned_calibration_file;
  std::error_code ignored;
  if (file.empty() || !std::filesystem::exists(file, ignored)) return;
  const auto learned = load_learned(file, rig_crc32(rig));
  if (!learned) return spdlog::warn("{}", learned.error().message);
  const Status restored = localizer.restore_calibration(learned->errors, learned->covariance);
  if (!restored) {
    spdlog::warn("{}: {}; they are not used, and bevlocd learns them again", file.string(),
                 restored.error().message);
  }
}

}  // namespace

Result<std::unique_ptr<Appliance>> Appliance::create(const Config& config, const Rig& rig,
                                                     const HdMap& map, Hardware hardware) {
  auto map_index = std::make_unique<MapIndex>(map);
  auto localizer = at_key(
      "model.file",
      Localizer::create(rig, *map_index, config.model_file.string(), localizer_options_of(config)));
  if (!localizer) return tl::unexpected(localizer.error());
  log_identity(identity_of(config, map), map, (*localizer)->model_name());
  restore_calibration(config, rig, **localizer);
  if (config.can.vehicle) {
    for (const std::string& warning : can::warnings_of(*config.can.vehicle)) {
      spdlog::warn("can.vehicle: {}", warning);
    }
  }
  std::unique_ptr<Appliance> appliance(
      new Appliance(config, map, std::move(hardware), std::move(map_index), std::move(*localizer)));
  if (config.can.secoc) {
    if (Status status = appliance->authenticate(*config.can.secoc, config.can.base_ids); !status) {
      return tl::unexpected(status.error());
    }
  }
  return appliance;
}

Appliance::Appliance(const Config& config, const HdMap& map, Hardware hardware,
                     std::unique_ptr<MapIndex> map_index, std::unique_ptr<Localizer> localizer)
    : hardware_(std::move(hardware)),
      map_index_(std::move(map_index)),
      localizer_(std::move(localizer)),
      publisher_(*hardware_.bus, publisher_config(config, map)),
      vehicle_input_(
          *hardware_.bus,
          make_vehicle_decoder(config.can, {map.origin.latitude_deg, map.origin.longitude_deg}),
          queues_.samples),
      vision_(*localizer_,
              {config.cameras.synchronizer, config.cameras.compensate_motion, hardware_.pulses},
              queues_.frames, queues_.predictions, queues_.reports),
      estimation_(config.tracker, config.health, map_id_of(map), publisher_, queues_.samples,
                  queues_.reports, queues_.predictions) {
  estimation_.watch(vehicle_input_);
  if (config.gnss) {
    vehicle_input_.ignore_gnss();
    gnss_.emplace(*config.gnss,
                  can::GeodeticPosition{map.origin.latitude_deg, map.origin.longitude_deg},
                  *hardware_.clock, queues_.samples);
  }
  for (const auto& camera : hardware_.cameras) {
    capture_.emplace_back(*camera, *hardware_.clock, queues_.frames);
  }
}

Status Appliance::authenticate(const SecocConfig& config, const can::BaseIds& base) {
  const auto key = at_key("can.secoc.key_file", can::read_secoc_key(config.key_file));
  if (!key) return tl::unexpected(key.error());
  auto sending = can::Cmac::create(*key);
  auto receiving = can::Cmac::create(*key);
  if (!sending || !receiving) return tl::unexpected((sending ? receiving : sending).error());
  const auto start = at_key("can.secoc.starts_file", can::next_start_number(config.starts_file));
  if (!start) return tl::unexpected(start.error());
  if (*start == 1) {
    spdlog::warn(
        "can.secoc: {}: found no number of earlier starts, so this counts as start 1; if the "
        "vehicle has seen a later start, it refuses all messages: then write a larger number into "
        "this file, or change the key",
        config.starts_file.string());
  }
  publisher_.authenticate(can::SecocSender(std::move(*sending), *start));
  vehicle_input_.authenticate(can::SecocReceiver(std::move(*receiving), base));
  return {};
}

FrameCounts Appliance::frame_counts() const {
  FrameCounts counts;
  for (const CaptureStage& stage : capture_) counts.captured += stage.captured();
  counts.used = vision_.counters().frames_used;
  counts.displaced = queues_.frames.dropped();
  counts.skipped = vision_.framesets().counters().frames_skipped;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    counts.mismatched += vision_.framesets().frames_of(camera).refused();
    counts.missed += hardware_.cameras[camera]->counters().missed();
  }
  return counts;
}

QueueDrops Appliance::queue_drops() const {
  return {.samples = queues_.samples.dropped(),
          .reports = queues_.reports.dropped(),
          .predictions = queues_.predictions.dropped()};
}

can::PosePublisherConfig publisher_config(const Config& config, const HdMap& map) {
  can::PosePublisherConfig publisher;
  publisher.base_ids = config.can.base_ids;
  publisher.format = config.can.variant;
  publisher.identity = identity_of(config, map);
  publisher.sends_clock = config.can.sends_clock;
  publisher.map_origin = {map.origin.latitude_deg, map.origin.longitude_deg};
  return publisher;
}

}  // namespace bevloc::firmware
