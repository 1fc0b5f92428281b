// The stages of the appliance and the queues between them.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "can/bus.h"
#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "firmware/capture_stage.h"
#include "firmware/config.h"
#include "firmware/estimation_stage.h"
#include "firmware/vehicle_input_stage.h"
#include "firmware/vision_stage.h"

namespace bevloc::firmware {

/// What the appliance stands on, real or mock.
struct Hardware {
  std::vector<std::unique_ptr<drivers::Camera>> cameras;  ///< in the order of kCameraNames
  std::unique_ptr<can::Bus> bus;
  drivers::Clock* clock = nullptr;
  const drivers::PulseLog* pulses = nullptr;  ///< of the trigger, where there is one
};

/// How many frames went which way, summed over the cameras.
struct FrameCounts {
  uint64_t missed = 0;      ///< never captured, as the cameras' drivers counted
  uint64_t captured = 0;    ///< handed over by the cameras
  uint64_t used = 0;        ///< in a frameset that was localized
  uint64_t displaced = 0;   ///< by newer ones, before vision looked at them
  uint64_t mismatched = 0;  ///< refused by the synchronizer, or in a set of too few cameras
  uint64_t skipped = 0;     ///< in a frameset that a newer one made useless
  uint64_t dropped() const { return captured - used; }
  /// Waiting for their set; dropped only if that never comes.
  uint64_t under_way() const { return dropped() - displaced - mismatched - skipped; }
};

/// Everything that runs, ready to be driven by threads or in lockstep (runner.h). Stages talk
/// through bounded queues alone.
class Appliance {
 public:
  /// Fails when the model or the solver cannot be made. The map must outlive the appliance.
  static Result<std::unique_ptr<Appliance>> create(const Config& config, const Rig& rig,
                                                   const HdMap& map, Hardware hardware);

  drivers::Clock& clock() { return *hardware_.clock; }
  std::deque<CaptureStage>& capture() { return capture_; }
  VehicleInputStage& vehicle_input() { return vehicle_input_; }
  VisionStage& vision() { return vision_; }
  EstimationStage& estimation() { return estimation_; }
  const VisionStage& vision() const { return vision_; }
  const EstimationStage& estimation() const { return estimation_; }
  const Localizer& localizer() const { return *localizer_; }
  const MapIndex& map_index() const { return *map_index_; }
  const can::Bus& bus() const { return *hardware_.bus; }

  FrameCounts frame_counts() const;

  /// Wakes every stage that waits, for the end.
  void close();

 private:
  Appliance(const Config& config, const HdMap& map, Hardware hardware,
            std::unique_ptr<MapIndex> map_index, std::unique_ptr<Localizer> localizer);

  Hardware hardware_;
  std::unique_ptr<MapIndex> map_index_;
  std::unique_ptr<Localizer> localizer_;

  FrameQueue frames_;
  VehicleQueue samples_;
  PredictionQueue predictions_;
  VisionQueue reports_;

  can::PosePublisher publisher_;
  std::deque<CaptureStage> capture_;  ///< a deque because a stage cannot move
  VehicleInputStage vehicle_input_;
  VisionStage vision_;
  EstimationStage estimation_;
};

/// What the configuration says of these parts.
can::PosePublisherConfig publisher_config(const Config& config, const HdMap& map);
LocalizerOptions localizer_options(const Config& config);

/// Of everything the map holds; consumers of LOC_Status know a map by it.
uint16_t map_id_of(const HdMap& map);

}  // namespace bevloc::firmware
