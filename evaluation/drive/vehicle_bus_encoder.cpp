#include "evaluation/drive/vehicle_bus_encoder.h"

#include "sim/faults/fault_table.h"

namespace bevloc::evaluation {
namespace {

std::variant<can::VehicleEncoder, DbcVehicleEncoder> encoder_for(const firmware::CanConfig& can,
                                                                 can::GeodeticPosition map_origin,
                                                                 double rear_track_m) {
  if (can.vehicle) return DbcVehicleEncoder(*can.vehicle, map_origin, rear_track_m);
  return can::VehicleEncoder(can.base_ids, map_origin, rear_track_m);
}

}  // namespace

VehicleBusEncoder::VehicleBusEncoder(const firmware::CanConfig& can,
                                     can::GeodeticPosition map_origin, double rear_track_m)
    : encoder_(encoder_for(can, map_origin, rear_track_m)) {}

std::span<const can::Frame> VehicleBusEncoder::odometry(const can::WheelOdometry& measured) {
  return std::visit([&](auto& encoder) { return keep(encoder.odometry(measured)); }, encoder_);
}

std::span<const can::Frame> VehicleBusEncoder::odometry(const OdometrySample& sample) {
  return std::visit([&](auto& encoder) { return keep(encoder.odometry(sample)); }, encoder_);
}

std::span<const can::Frame> VehicleBusEncoder::gnss(const GnssSample& sample) {
  return std::visit([&](auto& encoder) { return keep(encoder.gnss(sample)); }, encoder_);
}

std::span<const can::Frame> VehicleBusEncoder::keep(std::span<const can::Frame> frames) {
  frames_.assign(frames.begin(), frames.end());
  return frames_;
}

Status check_expressible(const sim::Fault& fault, const firmware::CanConfig& can) {
  if (fault.kind != sim::FaultKind::kGnssNoHeading || !can.vehicle || !can.vehicle->gnss) return {};
  const can::BoundGnss& gnss = *can.vehicle->gnss;
  if (!gnss.heading || gnss.heading_valid) return {};
  return fail(
      "found {}, wanted can.vehicle.gnss.heading_valid too, because without it every heading on "
      "this bus is valid",
      sim::info_of(fault.kind).name);
}

}  // namespace bevloc::evaluation
