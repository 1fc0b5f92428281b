// The appliance: all stages and the queues between them.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "can/bus/bus.h"
#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "firmware/config/config.h"
#include "firmware/stages/capture_stage.h"
#include "firmware/stages/estimation_stage.h"
#include "firmware/stages/gnss_stage.h"
#include "firmware/stages/vehicle_input_stage.h"
#include "firmware/stages/vision_stage.h"
#include "firmware/threads/heartbeat.h"

namespace bevloc::firmware {

/// The devices of an appliance, real or mock.
struct Hardware {
  std::vector<std::unique_ptr<drivers::Camera>> cameras;  ///< in the order of kCameraNames
  std::unique_ptr<can::Bus> bus;
  drivers::Clock* clock = nullptr;            ///< must outlive the appliance
  const drivers::PulseLog* pulses = nullptr;  ///< pulses of the trigger; null without one
};

/// The heartbeats of the threads that run one stage each. A capture stage has its own.
struct StageHeartbeats {
  Heartbeat vision;
  Heartbeat can_in;
  Heartbeat can_out;
  Heartbeat gnss;  ///< used only with a GNSS stage
};

/// Where the frames of all cameras went.
struct FrameCounts {
  uint64_t missed = 0;      ///< lost before capture, as the camera drivers counted
  uint64_t captured = 0;    ///< delivered by the cameras
  uint64_t used = 0;        ///< frames in a frameset that vision took
  uint64_t displaced = 0;   ///< dropped from the full queue by newer frames
  uint64_t mismatched = 0;  ///< refused by the synchronizer, or in a frameset with too few cameras
  uint64_t skipped = 0;     ///< in a frameset that was skipped for a newer one
  uint64_t dropped() const { return captured - used; }
  /// Frames that still wait for their frameset.
  uint64_t under_way() const { return dropped() - displaced - mismatched - skipped; }
};

/// Entries other than frames that newer ones displaced from the queues between the stages.
struct QueueDrops {
  uint64_t samples = 0;  ///< odometry and GNSS samples that estimation did not read in time
  uint64_t reports = 0;  ///< reports of vision that estimation did not read in time
  /// Predicted poses that vision did not need. There are many if no framesets come.
  uint64_t predictions = 0;
};

/// Owns stages, queues and devices. The functions of runner.h run it, with threads or in lockstep.
/// Stages exchange data through bounded queues only. The constructor starts no thread. Each stage
/// states its own thread rule. close() is thread-safe, and the counts are readable from any thread.
class Appliance {
 public:
  /// Fails when the model cannot be loaded or the solver does not support the hypotheses. `map`
  /// must outlive the appliance.
  static Result<std::unique_ptr<Appliance>> create(const Config& config, const Rig& rig,
                                                   const HdMap& map, Hardware hardware);

  drivers::Clock& clock() { return *hardware_.clock; }
  std::deque<CaptureStage>& capture() { return capture_; }
  const std::deque<CaptureStage>& capture() const { return capture_; }
  StageHeartbeats& heartbeats() { return heartbeats_; }
  const StageHeartbeats& heartbeats() const { return heartbeats_; }
  VehicleInputStage& vehicle_input() { return vehicle_input_; }
  const VehicleInputStage& vehicle_input() const { return vehicle_input_; }
  /// The GNSS stage, or null if GNSS comes on the bus.
  GnssStage* gnss() { return gnss_ ? &*gnss_ : nullptr; }
  const GnssStage* gnss() const { return gnss_ ? &*gnss_ : nullptr; }
  VisionStage& vision() { return vision_; }
  EstimationStage& estimation() { return estimation_; }
  const VisionStage& vision() const { return vision_; }
  const EstimationStage& estimation() const { return estimation_; }
  const Localizer& localizer() const { return *localizer_; }
  const MapIndex& map_index() const { return *map_index_; }
  const can::Bus& bus() const { return *hardware_.bus; }

  /// Returns the counts, which are exact only after all threads have ended.
  FrameCounts frame_counts() const;
  /// Returns the numbers of entries that the queues dropped.
  QueueDrops queue_drops() const;

  /// Wakes every stage that waits for a queue, so that its thread can end.
  void close() { queues_.close(); }

 private:
  Appliance(const Config& config, const HdMap& map, Hardware hardware,
            std::unique_ptr<MapIndex> map_index, std::unique_ptr<Localizer> localizer);
  Status authenticate(const SecocConfig& config, const can::BaseIds& base);

  Hardware hardware_;
  std::unique_ptr<MapIndex> map_index_;
  std::unique_ptr<Localizer> localizer_;
  StageQueues queues_;
  can::PosePublisher publisher_;
  std::deque<CaptureStage> capture_;  ///< a deque, because a stage cannot be moved
  VehicleInputStage vehicle_input_;
  std::optional<GnssStage> gnss_;
  VisionStage vision_;
  EstimationStage estimation_;
  StageHeartbeats heartbeats_;
};

/// The configuration of the publisher.
can::PosePublisherConfig publisher_config(const Config& config, const HdMap& map);

}  // namespace bevloc::firmware
