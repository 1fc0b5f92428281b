#include "firmware/appliance.h"

#include <bit>

namespace bevloc::firmware {
namespace {

// A vision report and a vehicle sample are read every bus cycle; these hold many cycles.
constexpr size_t kReportCapacity = 16;
constexpr size_t kSampleCapacity = 256;
// A prediction is made every bus cycle and read at every frameset, up to a second apart.
constexpr size_t kPredictionCapacity = 128;
// Two framesets: what is older is of no use to anybody.
constexpr size_t kFrameCapacity = 2 * kCameraCount;

}  // namespace

Result<std::unique_ptr<Appliance>> Appliance::create(const Config& config, const Rig& rig,
                                                     const HdMap& map, Hardware hardware) {
  auto map_index = std::make_unique<MapIndex>(map);
  auto localizer =
      Localizer::create(rig, *map_index, config.model_file.string(), localizer_options(config));
  if (!localizer) return tl::unexpected(localizer.error());
  return std::unique_ptr<Appliance>(
      new Appliance(config, map, std::move(hardware), std::move(map_index), std::move(*localizer)));
}

Appliance::Appliance(const Config& config, const HdMap& map, Hardware hardware,
                     std::unique_ptr<MapIndex> map_index, std::unique_ptr<Localizer> localizer)
    : hardware_(std::move(hardware)),
      map_index_(std::move(map_index)),
      localizer_(std::move(localizer)),
      frames_(kFrameCapacity),
      samples_(kSampleCapacity),
      predictions_(kPredictionCapacity),
      reports_(kReportCapacity),
      publisher_(*hardware_.bus, publisher_config(config, map)),
      vehicle_input_(*hardware_.bus, config.can.base_ids,
                     {map.origin.latitude_deg, map.origin.longitude_deg}, samples_),
      vision_(*localizer_,
              {config.cameras.synchronizer, config.cameras.compensate_motion, hardware_.pulses},
              frames_, predictions_, reports_),
      estimation_(config.tracker, config.health, map_id_of(map), publisher_, samples_, reports_,
                  predictions_) {
  for (const auto& camera : hardware_.cameras) {
    capture_.emplace_back(*camera, *hardware_.clock, frames_);
  }
}

FrameCounts Appliance::frame_counts() const {
  FrameCounts counts;
  for (const CaptureStage& stage : capture_) counts.captured += stage.captured();
  counts.used = vision_.counters().frames_used;
  counts.displaced = frames_.dropped();
  counts.skipped = vision_.counters().frames_skipped;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const drivers::SynchronizerCounters& refused = vision_.synchronizer().counters(camera);
    counts.mismatched += refused.duplicate + refused.out_of_order + refused.late + refused.future +
                         refused.overflow + refused.unmatched;
    const drivers::CameraCounters missed = hardware_.cameras[camera]->counters();
    counts.missed += missed.no_buffer + missed.overrun + missed.lost + missed.damaged;
  }
  return counts;
}

void Appliance::close() {
  frames_.close();
  samples_.close();
  predictions_.close();
  reports_.close();
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
  // FNV-1a over every coordinate, folded to 16 bits.
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
