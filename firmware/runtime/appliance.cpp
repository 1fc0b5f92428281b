#include "firmware/runtime/appliance.h"

#include <bit>

#include <spdlog/spdlog.h>

#include "common/crc32.h"
#include "common/files.h"
#include "common/version.h"

namespace bevloc::firmware {
namespace {

/// Logs what identifies a run: version, model and map.
void log_identity(const Config& config, const HdMap& map, const Localizer& localizer) {
  const auto model = read_file(config.model_file);
  spdlog::info("bevloc {}: model {} (CRC-32 {:08x}), map {} (id {:#06x}, {} elements)", version(),
               localizer.model_name(), model ? crc32(*model) : 0U, map.name, map_id_of(map),
               map.elements.size());
}

}  // namespace

Result<std::unique_ptr<Appliance>> Appliance::create(const Config& config, const Rig& rig,
                                                     const HdMap& map, Hardware hardware) {
  auto map_index = std::make_unique<MapIndex>(map);
  auto localizer =
      Localizer::create(rig, *map_index, config.model_file.string(), localizer_options(config));
  if (!localizer) return tl::unexpected(localizer.error());
  log_identity(config, map, **localizer);
  return std::unique_ptr<Appliance>(
      new Appliance(config, map, std::move(hardware), std::move(map_index), std::move(*localizer)));
}

Appliance::Appliance(const Config& config, const HdMap& map, Hardware hardware,
                     std::unique_ptr<MapIndex> map_index, std::unique_ptr<Localizer> localizer)
    : hardware_(std::move(hardware)),
      map_index_(std::move(map_index)),
      localizer_(std::move(localizer)),
      publisher_(*hardware_.bus, publisher_config(config, map)),
      vehicle_input_(*hardware_.bus, config.can.base_ids,
                     {map.origin.latitude_deg, map.origin.longitude_deg}, queues_.samples),
      vision_(*localizer_,
              {config.cameras.synchronizer, config.cameras.compensate_motion, hardware_.pulses},
              queues_.frames, queues_.predictions, queues_.reports),
      estimation_(config.tracker, config.health, map_id_of(map), publisher_, queues_.samples,
                  queues_.reports, queues_.predictions) {
  for (const auto& camera : hardware_.cameras) {
    capture_.emplace_back(*camera, *hardware_.clock, queues_.frames);
  }
}

FrameCounts Appliance::frame_counts() const {
  FrameCounts counts;
  for (const CaptureStage& stage : capture_) counts.captured += stage.captured();
  counts.used = vision_.counters().frames_used;
  counts.displaced = queues_.frames.dropped();
  counts.skipped = vision_.framesets().counters().frames_skipped;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const drivers::SynchronizerCounters refused = vision_.framesets().frames_of(camera);
    counts.mismatched += refused.duplicate + refused.out_of_order + refused.late + refused.future +
                         refused.overflow + refused.unmatched;
    const drivers::CameraCounters missed = hardware_.cameras[camera]->counters();
    counts.missed += missed.no_buffer + missed.overrun + missed.lost + missed.damaged;
  }
  return counts;
}

can::PosePublisherConfig publisher_config(const Config& config, const HdMap& map) {
  can::PosePublisherConfig publisher;
  publisher.base_ids = config.can.base_ids;
  publisher.format = config.can.variant;
  publisher.map_origin = {map.origin.latitude_deg, map.origin.longitude_deg};
  return publisher;
}

LocalizerOptions localizer_options(const Config& config) {
  LocalizerOptions options;
  options.solver = config.solver.kind;
  options.tracking = config.solver.tracking;
  options.acquiring = config.solver.acquiring;
  return options;
}

uint16_t map_id_of(const HdMap& map) {
  // FNV-1a over origin, classes and coordinates, folded to 16 bits.
  uint64_t hash = 0xCBF29CE484222325ULL;
  const auto mix = [&hash](double value) {
    hash = (hash ^ std::bit_cast<uint64_t>(value)) * 0x100000001B3ULL;
  };
  mix(map.origin.latitude_deg);
  mix(map.origin.longitude_deg);
  for (const MapElement& element : map.elements) {
    mix(static_cast<double>(element.element_class));
    for (const Eigen::Vector2d& point : element.points) {
      mix(point.x());
      mix(point.y());
    }
  }
  return static_cast<uint16_t>(hash ^ (hash >> 16U) ^ (hash >> 32U) ^ (hash >> 48U));
}

}  // namespace bevloc::firmware
