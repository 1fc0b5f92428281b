// Times a whole frame: from six decoded images to CAN frames, by the daemon's own stages.
#pragma once

#include <memory>
#include <optional>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"
#include "drivers/clock/clock.h"
#include "evaluation/bench/scene.h"
#include "evaluation/bench/standing_vehicle.h"
#include "firmware/stages/estimation_stage.h"
#include "firmware/stages/vision_stage.h"

namespace bevloc::bench {

struct FrameRun {
  Duration time{0};
  uint64_t allocations = 0;
  int can_frames = 0;    ///< number of CAN frames sent
  bool tracked = false;  ///< the state afterwards is TRACKING
};

/// The vision and the estimation stage with the queues between them, in lockstep on a virtual
/// clock. Timing starts when the images are in memory. One thread.
class WholeFrame {
 public:
  /// `map` and `index` must outlive this object. Fails as Localizer::create() does.
  static Result<std::unique_ptr<WholeFrame>> create(const firmware::Config& config, const Rig& rig,
                                                    const HdMap& map, const MapIndex& index,
                                                    int threads);

  /// Moves the vehicle to a place. Returns whether, within kMostFrames, the pose becomes tracked
  /// there and stays so with each of the place's framesets.
  bool settle(const Place& place);
  static constexpr size_t kMostFrames = 60;

  /// Processes the next frameset: frames into the queue, localization, correction, CAN frames out.
  FrameRun run(const FramesetImages& images);

  const std::string& model_name() const { return localizer_->model_name(); }
  Localizer& localizer() { return *localizer_; }

 private:
  WholeFrame(const firmware::Config& config, const HdMap& map,
             std::unique_ptr<Localizer> localizer);
  void drive_until(Time time);
  int take_sent();

  firmware::Config config_;
  const HdMap& map_;
  std::unique_ptr<Localizer> localizer_;
  can::MockWire wire_;
  std::unique_ptr<can::Bus> bus_;
  std::unique_ptr<can::Bus> listener_;
  firmware::StageQueues queues_;
  std::optional<can::PosePublisher> publisher_;
  std::optional<firmware::VisionStage> vision_;
  std::optional<firmware::EstimationStage> estimation_;
  std::shared_ptr<drivers::FrameLender> lender_;
  drivers::MonotonicClock machine_clock_;
  drivers::VirtualClock clock_;
  StandingVehicle vehicle_;
  Time exposure_;
  uint64_t sequence_ = 0;
};

}  // namespace bevloc::bench
