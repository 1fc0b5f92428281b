// A node that floods the simulated bus, forges odometry and replays old frames.
#pragma once

#include <deque>

#include "can/bus/bus.h"
#include "evaluation/drive/vehicle_bus_encoder.h"
#include "sim/faults/fault_board.h"

namespace bevloc::evaluation {

/// One thread.
class BusAttacker {
 public:
  /// Forges odometry in the messages of `encoder`.
  explicit BusAttacker(const VehicleBusEncoder& encoder) : encoder_(encoder) {}

  /// Records a frame that the vehicle sent `elapsed_s` after the drive's start.
  void note(const can::Frame& frame, double elapsed_s);

  /// Sends what the active faults ask for. Called once per odometry period.
  void act(const sim::FaultBoard& faults, double elapsed_s, can::Bus& bus, Time now);

 private:
  struct Noted {
    can::Frame frame;
    double elapsed_s;
  };

  void flood(double rate_hz, double elapsed_s, can::Bus& bus, Time now) const;
  void forge(const sim::FaultAmounts& by, can::Bus& bus, Time now);
  void replay(double age_s, double elapsed_s, can::Bus& bus, Time now) const;

  VehicleBusEncoder encoder_;  ///< with counters of its own
  std::deque<Noted> noted_;    ///< the frames of the last minute
};

}  // namespace bevloc::evaluation
