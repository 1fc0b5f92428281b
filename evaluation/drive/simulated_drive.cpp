#include "evaluation/drive/simulated_drive.h"

#include <cmath>
#include <optional>

#include "drivers/mock/true_rig.h"
#include "evaluation/drive/configured_world.h"
#include "evaluation/drive/drive_street.h"
#include "evaluation/drive/reference_receiver.h"
#include "sim/faults/drive_clock.h"
#include "sim/faults/gnss_faults.h"
#include "sim/faults/map_faults.h"
#include "sim/faults/odometry_faults.h"
#include "sim/faults/world_faults.h"
#include "sim/random.h"
#include "sim/render/photo_library.h"

namespace bevloc::evaluation {
namespace {

constexpr double kRearTrack_m = 1.6;
constexpr Duration kExposure = std::chrono::milliseconds(8);
constexpr Duration kReadout = std::chrono::milliseconds(20);
/// The drive continues beyond the configured duration, so that it does not end while the daemon
/// runs.
constexpr double kSpareDuration_s = 10.0;

can::WheelOdometry measured_from(const sim::WheelReading& reading) {
  return {.left_mps = reading.left_mps,
          .right_mps = reading.right_mps,
          .yaw_rate_radps = reading.yaw_rate_radps,
          .front_speed_mps = reading.front_speed_mps,
          .front_yaw_rate_radps = reading.front_yaw_rate_radps};
}

GnssSample sample_of(const sim::GnssReading& reading, Time now) {
  GnssSample sample;
  sample.time = now;
  sample.east_m = reading.position_m.x();
  sample.north_m = reading.position_m.y();
  sample.sigma_east_m = reading.position_sigma_m;
  sample.sigma_north_m = reading.position_sigma_m;
  if (reading.has_heading) sample.yaw = {reading.heading_rad, reading.heading_sigma_rad};
  return sample;
}

}  // namespace

SimulatedVehicle::SimulatedVehicle(const SimulatedDrive& drive, uint64_t seed,
                                   const firmware::CanConfig& can, std::unique_ptr<can::Bus> bus,
                                   Time drive_start)
    : drive_(drive.drive()),
      faults_(drive.faults()),
      odometry_(*drive_, sim::seed_for(seed, "odometry")),
      gnss_(*drive_, sim::seed_for(seed, "gnss")),
      encoder_(can, {drive.map().origin.latitude_deg, drive.map().origin.longitude_deg},
               kRearTrack_m),
      attacker_(encoder_),
      bus_(std::move(bus)),
      odometry_times_(sim::OdometrySimulator::kPeriod_s, drive_start),
      gnss_times_(sim::GnssSimulator::kPeriod_s, drive_start) {}

std::optional<SimulatedVehicle::ReadingTimes::Reading> SimulatedVehicle::ReadingTimes::take(
    uint64_t readings, std::span<const sim::Fault> clock_faults) {
  const double elapsed_s = static_cast<double>(count_) * period_s_;
  ++count_;
  next_ = drive_start_ + from_seconds(static_cast<double>(count_) * period_s_);
  const auto index =
      static_cast<uint64_t>(std::llround(sim::drive_time_s(elapsed_s, clock_faults) / period_s_));
  if (index >= readings || sim::is_in_clock_gap(elapsed_s, clock_faults)) return std::nullopt;
  return Reading{index, elapsed_s};
}

void SimulatedVehicle::send_due(Time now) {
  while (odometry_times_.next() <= now) send_odometry(now);
  while (gnss_times_.next() <= now) send_gnss(now);
}

void SimulatedVehicle::send(std::span<const can::Frame> frames, double elapsed_s, Time now) {
  for (const can::Frame& frame : frames) {
    bus_->send(frame, now);
    attacker_.note(frame, elapsed_s);
  }
}

void SimulatedVehicle::send_odometry(Time now) {
  const auto clock_faults = faults_->all(sim::FaultInput::kClock);
  const auto due = odometry_times_.take(odometry_.count(), clock_faults);
  if (!due) return;
  const auto reading = sim::reading_with_faults(
      odometry_, due->index, kRearTrack_m,
      sim::in_drive_time(faults_->active(sim::FaultInput::kOdometry, due->elapsed_s),
                         clock_faults));
  if (reading) send(encoder_.odometry(measured_from(*reading)), due->elapsed_s, now);
  attacker_.act(*faults_, due->elapsed_s, *bus_, now);
}

void SimulatedVehicle::send_gnss(Time now) {
  const auto clock_faults = faults_->all(sim::FaultInput::kClock);
  const auto due = gnss_times_.take(gnss_.count(), clock_faults);
  if (!due) return;
  const auto reading = sim::reading_with_faults(
      gnss_, due->index,
      sim::in_drive_time(faults_->active(sim::FaultInput::kGnss, due->elapsed_s), clock_faults),
      *drive_);
  if (reading) send(encoder_.gnss(sample_of(*reading, now)), due->elapsed_s, now);
}

Result<SimulatedDrive> SimulatedDrive::create(const DriveConfig& config) {
  const SimulationConfig& simulation = *config.simulation;
  for (const sim::Fault& fault : simulation.faults) {
    const Status expressible = check_expressible(fault, config.can);
    if (!expressible) return fail("simulation.faults: {}", expressible.error().message);
  }
  auto world = make_configured_world(config);
  if (!world) return tl::unexpected(world.error());
  struct PhotographedWorld {
    sim::World world;
    std::optional<sim::PhotoLibrary> photos;
  };
  const auto owned = std::make_shared<PhotographedWorld>();
  owned->world = sim::with_faults(std::move(*world), simulation.faults);
  if (!simulation.street.photos.empty()) {
    auto photos = sim::PhotoLibrary::load(simulation.street.photos);
    if (!photos) return tl::unexpected(photos.error());
    owned->photos.emplace(std::move(*photos));
    owned->world.photos = &*owned->photos;
  }
  return SimulatedDrive(std::shared_ptr<const sim::World>(owned, &owned->world), simulation);
}

SimulatedDrive::SimulatedDrive(std::shared_ptr<const sim::World> world,
                               const SimulationConfig& simulation)
    : world_(std::move(world)),
      drive_(make_configured_drive(*world_, simulation,
                                   kSpareDuration_s + sim::added_time_s(simulation.faults))),
      faults_(std::make_shared<sim::FaultBoard>(simulation.faults)),
      map_(sim::with_faults(world_->map, sim::in_drive_time(simulation.faults, simulation.faults),
                            *drive_)) {}

double SimulatedDrive::drive_time_s(double elapsed_s) const {
  return sim::drive_time_s(elapsed_s, faults_->all(sim::FaultInput::kClock));
}

Se2 SimulatedDrive::truth_at(double elapsed_s) const {
  return drive_->at(drive_time_s(elapsed_s)).map_from_vehicle;
}

ReferenceTrajectory SimulatedDrive::reference(uint64_t seed, Time drive_start) const {
  const double suspended_s = sim::added_time_s(faults_->all(sim::FaultInput::kClock));
  return receive_reference([this](double elapsed_s) { return truth_at(elapsed_s); },
                           drive_->duration_s() - suspended_s, sim::seed_for(seed, "reference"),
                           drive_start);
}

std::vector<std::unique_ptr<drivers::Camera>> SimulatedDrive::make_cameras(
    const DriveConfig& config, const Rig& rig, drivers::Clock& clock, Time drive_start,
    const std::shared_ptr<drivers::PictureCache>& pictures) const {
  const SimulationConfig& simulation = *config.simulation;
  const auto scene = std::make_shared<drivers::MockScene>(
      world_, drive_, simulation.conditions, sim::seed_for(simulation.seed, "pixel noise"),
      pictures, street_of(simulation.street, simulation.seed));
  const Rig true_rig = drivers::true_rig(rig, simulation.calibration_error,
                                         sim::seed_for(simulation.seed, "calibration"));
  std::vector<std::unique_ptr<drivers::Camera>> cameras;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    drivers::MockCameraConfig mock;
    mock.camera = camera;
    mock.true_rig = true_rig;
    mock.timing.drive_start = drive_start;
    mock.timing.period = from_seconds(1.0 / config.cameras.rate_hz);
    mock.timing.phase = simulation.exposure_offsets[camera];
    mock.timing.exposure = kExposure;
    mock.timing.readout = kReadout;
    mock.buffers = config.cameras.buffers;
    mock.faults = faults_;
    mock.fault_seed = sim::seed_for(simulation.seed, "picture faults");
    cameras.push_back(std::make_unique<drivers::MockCamera>(scene, mock, clock));
  }
  return cameras;
}

}  // namespace bevloc::evaluation
