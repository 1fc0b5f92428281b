#include "evaluation/campaign/pictures_run.h"

#include <utility>

#include "can/bus/mock_bus.h"
#include "evaluation/drive/clock_faults.h"
#include "evaluation/drive/faulty_bus.h"
#include "evaluation/drive/simulated_drive.h"
#include "firmware/runtime/runner.h"

namespace bevloc::evaluation {
namespace {

/// Time for the cameras to render their first images before the drive begins.
constexpr Duration kPicturesLead = std::chrono::milliseconds(500);
/// The number of frames that the bus can carry in 100 ms.
constexpr size_t kWireCapacity = 4096;

}  // namespace

Status run_pictures(const DriveConfig& config, const Rig& rig,
                    const std::shared_ptr<drivers::PictureCache>& pictures, const CycleSink& sink) {
  auto drive = SimulatedDrive::create(config);
  if (!drive) return tl::unexpected(drive.error());
  drivers::VirtualClock clock;
  const Time drive_start = clock.now() + kPicturesLead;
  can::MockWire wire(kWireCapacity);
  firmware::Hardware hardware{drive->make_cameras(config, rig, clock, drive_start, pictures),
                              std::make_unique<FaultyBus>(wire.connect(), drive->faults(), clock,
                                                          drive_start, config.simulation->seed),
                              &clock};
  auto appliance = firmware::Appliance::create(config, rig, drive->map(), std::move(hardware));
  if (!appliance) return tl::unexpected(appliance.error());
  SimulatedVehicle vehicle(*drive, config.simulation->seed, config.can, wire.connect(),
                           drive_start);
  CycleReader reader(
      wire.connect(), config.can.base_ids, drive->map().origin,
      [&drive](double time_s) { return drive->truth_at(time_s); }, drive_start);
  ClockFaults clock_faults(drive->faults());
  const firmware::Companion companion{[&vehicle] { return vehicle.next_due(); },
                                      [&](Time now) {
                                        const double time_s = to_seconds(now - drive_start);
                                        clock.suspend(clock_faults.suspension_due(time_s));
                                        vehicle.send_due(now);
                                      },
                                      [&](Duration) {
                                        const JudgedCycle cycle = reader.step(clock.now());
                                        if (cycle.time_s >= 0.0) sink(cycle);
                                      }};
  const double duration_s = config.simulation->duration_s;
  firmware::run_lockstep(**appliance, clock, &companion, [&](Time now) {
    const double time_s = to_seconds(now - drive_start);
    clock.advance(clock_faults.gap_due(time_s));
    return time_s < duration_s;
  });
  return {};
}

}  // namespace bevloc::evaluation
