// From six decoded pictures to CAN frames by the daemon's own stages, timed as one.
#pragma once

#include <memory>
#include <optional>

#include "can/mock_bus.h"
#include "can/pose_publisher.h"
#include "drivers/clock/clock.h"
#include "firmware/bench/scene.h"
#include "firmware/bench/standing_vehicle.h"
#include "firmware/estimation_stage.h"
#include "firmware/vision_stage.h"

namespace bevloc::bench {

struct FrameRun {
  Duration time{0};
  uint64_t allocations = 0;
  int can_frames = 0;    ///< sent
  bool tracked = false;  ///< the state is TRACKING afterwards
};

/// The vision and the estimation stage with the queues between them, in lockstep on a virtual
/// clock; only what follows the pictures' arrival is timed. Not thread safe.
class WholeFrame {
 public:
  /// `map` and `pictures` must outlive it; fails as Localizer::create() does.
  static Result<std::unique_ptr<WholeFrame>> create(const firmware::Config& config, const Rig& rig,
                                                    const HdMap& map, const MapIndex& index,
                                                    int threads);

  /// The vehicle stands here from now on. Says whether the pose is tracked within kMostFrames.
  bool settle(const Place& place);
  static constexpr int kMostFrames = 60;

  /// The next frameset: frames into the queue, localization, correction, CAN frames out.
  FrameRun run(const Pictures& pictures);

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
  firmware::FrameQueue frames_;
  firmware::VehicleQueue samples_;
  firmware::PredictionQueue predictions_;
  firmware::VisionQueue reports_;
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
