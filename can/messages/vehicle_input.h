// Decodes odometry and GNSS from the vehicle's CAN frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "can/e2e/e2e_monitor.h"
#include "can/messages/epoch_group.h"
#include "can/messages/message_table.h"
#include "can/messages/sample_maker.h"
#include "can/messages/vehicle_decoder.h"

namespace bevloc::can {

/// Uses only the frames that E2eMonitor accepts. Wheel speed and yaw rate of one epoch make an
/// odometry sample. Latitude, longitude and heading of one epoch make a GNSS sample, which has no
/// yaw if the heading is not available. One thread.
class VehicleInput final : public VehicleDecoder {
 public:
  /// `rear_track_m` is the distance between the rear wheels.
  VehicleInput(const BaseIds& base, GeodeticPosition map_origin, double rear_track_m);

  VehicleSamples accept(const ReceivedFrame& received) override;
  void note_gap() override { maker_.note_gap(); }
  VehicleInputCounters counters() const override;
  VehicleFaultTimes fault_times() const override { return maker_.fault_times(); }

  /// Returns the identifiers that a filter of the bus has to let pass, with or without
  /// authentication.
  static std::vector<uint32_t> accepted_ids(const BaseIds& base, bool secoc);

 private:
  static constexpr std::array<const Message*, 5> kInputs = {
      &veh_wheel_speed::kMessage, &veh_yaw_rate::kMessage, &veh_gnss_latitude::kMessage,
      &veh_gnss_longitude::kMessage, &veh_gnss_heading::kMessage};
  static constexpr size_t kFirstGnss = 2;

  std::optional<OdometrySample> odometry_from(const EpochGroup<2>::Set& set);
  std::optional<GnssSample> gnss_from(const EpochGroup<3>::Set& set);

  BaseIds base_;
  SampleMaker maker_;
  std::array<E2eMonitor, kInputs.size()> monitors_;
  EpochGroup<2> odometry_group_;
  EpochGroup<3> gnss_group_;
  VehicleInputCounters counters_;
};

}  // namespace bevloc::can
