// The simulated surroundings of the appliance: a world, a drive, the mock cameras and the vehicle's
// CAN nodes.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "can/bus/mock_bus.h"
#include "drivers/mock/mock_camera.h"
#include "evaluation/drive/bus_attacker.h"
#include "evaluation/drive/drive_config.h"
#include "evaluation/drive/vehicle_bus_encoder.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "sim/faults/fault_board.h"
#include "sim/sensors/gnss.h"
#include "sim/sensors/odometry.h"

namespace bevloc::evaluation {

/// A world and a drive through it, made from the configuration's seeds. The localizer gets only the
/// map, the camera images and the frames on the bus.
class SimulatedDrive {
 public:
  /// Fails as make_configured_world() does, and for a fault that the vehicle's bus cannot express.
  static Result<SimulatedDrive> create(const DriveConfig& config);

  /// The map that the appliance gets.
  const HdMap& map() const { return map_; }
  /// The vehicle's pose when the appliance's clock shows this time since the drive's start.
  Se2 truth_at(double elapsed_s) const;
  /// Whether the planned drive is over. A suspension that is set while the drive runs makes it end
  /// before the duration of the configuration.
  bool is_over(double elapsed_s) const { return drive_time_s(elapsed_s) >= drive_->duration_s(); }
  /// What the reference system receives on this drive (reference_receiver.h), in the times of the
  /// appliance's clock. Call it after the drive, because suspensions may be set while it runs.
  ReferenceTrajectory reference(uint64_t seed, Time drive_start) const;
  std::shared_ptr<const sim::Drive> drive() const { return drive_; }
  /// The faults of the configuration. More may be set while the drive runs.
  std::shared_ptr<sim::FaultBoard> faults() const { return faults_; }

  /// Mock cameras that see the drive, which begins at `drive_start`. The clock must outlive them.
  /// `pictures`: null without a cache.
  std::vector<std::unique_ptr<drivers::Camera>> make_cameras(
      const DriveConfig& config, const Rig& rig, drivers::Clock& clock, Time drive_start,
      const std::shared_ptr<drivers::PictureCache>& pictures = nullptr) const;

 private:
  SimulatedDrive(std::shared_ptr<const sim::World> world, const SimulationConfig& simulation);
  double drive_time_s(double elapsed_s) const;

  std::shared_ptr<const sim::World> world_;
  std::shared_ptr<const sim::Drive> drive_;
  std::shared_ptr<sim::FaultBoard> faults_;
  HdMap map_;
};

/// Sends the vehicle's odometry and GNSS of a drive on the bus, each with its own period and with
/// its faults. One thread.
class SimulatedVehicle {
 public:
  SimulatedVehicle(const SimulatedDrive& drive, uint64_t seed, const firmware::CanConfig& can,
                   std::unique_ptr<can::Bus> bus, Time drive_start);

  /// The time at which the next frames are due.
  Time next_due() const { return std::min(odometry_times_.next(), gnss_times_.next()); }

  /// Sends everything that is due at `now`.
  void send_due(Time now);

 private:
  /// When the readings of one sensor are due.
  class ReadingTimes {
   public:
    ReadingTimes(double period_s, Time drive_start)
        : period_s_(period_s), drive_start_(drive_start), next_(drive_start) {}

    Time next() const { return next_; }

    struct Reading {
      uint64_t index;    ///< among the readings of the sensor
      double elapsed_s;  ///< since the drive's start, by the appliance's clock
    };
    /// The reading that is due, which the next one then follows. Returns nothing in a gap of the
    /// clock, and after the sensor's last reading.
    std::optional<Reading> take(uint64_t readings, std::span<const sim::Fault> clock_faults);

   private:
    double period_s_;
    Time drive_start_;
    uint64_t count_ = 0;
    Time next_;
  };

  void send_odometry(Time now);
  void send_gnss(Time now);
  void send(std::span<const can::Frame> frames, double elapsed_s, Time now);

  std::shared_ptr<const sim::Drive> drive_;
  std::shared_ptr<const sim::FaultBoard> faults_;
  sim::OdometrySimulator odometry_;
  sim::GnssSimulator gnss_;
  VehicleBusEncoder encoder_;
  BusAttacker attacker_;
  std::unique_ptr<can::Bus> bus_;
  ReadingTimes odometry_times_;
  ReadingTimes gnss_times_;
};

}  // namespace bevloc::evaluation
