#include "evaluation/campaign/stage_run.h"

#include <utility>

#include "can/bus/mock_bus.h"
#include "can/publisher/pose_publisher.h"
#include "evaluation/campaign/modelled_vision.h"
#include "evaluation/drive/faulty_bus.h"
#include "evaluation/drive/simulated_drive.h"
#include "firmware/devices/can_bus.h"
#include "firmware/runtime/appliance.h"
#include "firmware/runtime/identity.h"
#include "sim/random.h"

namespace bevloc::evaluation {
namespace {

/// The drive does not start at time zero, because a real machine was started some time before.
constexpr Time kDriveStart{std::chrono::seconds(10)};

/// The stages of an appliance without cameras, and the nodes around them.
class StageRun {
 public:
  /// `drive` must outlive the run.
  StageRun(const DriveConfig& config, const Mode& mode, const MatchTable& table,
           const SimulatedDrive& drive)
      : fault_(mode.time_in(config.simulation->duration_s)),
        suspended_s_(mode.suspended_s),
        own_bus_(wire_.connect(), drive.faults(), clock_, kDriveStart, config.simulation->seed),
        vehicle_(drive, config.simulation->seed, config.can, wire_.connect(), kDriveStart),
        reader_(
            wire_.connect(), config.can.base_ids, drive.map().origin,
            [&drive](double time_s) { return drive.truth_at(time_s); }, kDriveStart),
        publisher_(own_bus_, firmware::publisher_config(config, drive.map())),
        input_(own_bus_,
               firmware::make_vehicle_decoder(
                   config.can, {drive.map().origin.latitude_deg, drive.map().origin.longitude_deg}),
               queues_.samples),
        vision_(MatchModel(table, config.solver.tracking, config.solver.acquiring,
                           sim::seed_for(config.simulation->seed, "matches")),
                drive.drive(), kDriveStart, {fault_, mode.match_faults}, queues_.predictions,
                queues_.reports),
        estimation_(config.tracker, config.health, firmware::map_id_of(drive.map()), publisher_,
                    queues_.samples, queues_.reports, queues_.predictions) {
    estimation_.watch(input_);
  }

  void run(double duration_s, const CycleSink& sink) {
    const Time end = kDriveStart + from_seconds(duration_s);
    for (; clock_.now() < end; clock_.advance(kSolutionCycle)) {
      const Time now = clock_.now();
      vehicle_.send_due(now);
      if (is_suspended(now)) {
        while (own_bus_.receive()) {
        }
        continue;
      }
      input_.step(clock_, Duration::zero());
      vision_.step(now);
      estimation_.tick(clock_);
      sink(reader_.step(now));
    }
  }

 private:
  bool is_suspended(Time now) const {
    const double time_s = to_seconds(now - kDriveStart);
    return time_s >= fault_.from_s && time_s < fault_.from_s + suspended_s_;
  }

  FaultTime fault_;
  double suspended_s_;
  drivers::VirtualClock clock_{kDriveStart};
  can::MockWire wire_{256};
  FaultyBus own_bus_;
  SimulatedVehicle vehicle_;
  CycleReader reader_;
  firmware::StageQueues queues_;
  can::PosePublisher publisher_;
  firmware::VehicleInputStage input_;
  ModelledVision vision_;
  firmware::EstimationStage estimation_;
};

}  // namespace

Status run_stage(const DriveConfig& config, const Mode& mode, const MatchTable& table,
                 const CycleSink& sink) {
  auto drive = SimulatedDrive::create(config);
  if (!drive) return tl::unexpected(drive.error());
  StageRun(config, mode, table, *drive).run(config.simulation->duration_s, sink);
  return {};
}

}  // namespace bevloc::evaluation
