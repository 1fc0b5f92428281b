#include "can/messages/vehicle_input.h"

#include <algorithm>
#include <utility>

namespace bevloc::can {
namespace {

/// The window is long enough for a busy bus, and short compared with the 16 cycles after which an
/// epoch repeats.
constexpr Duration window_of(int cycle_ms) {
  return std::chrono::milliseconds(4 * cycle_ms);
}

/// Odometry stays VALID down to one frame in 10 cycles (200 ms), which is the default of
/// `health.odometry_timeout_ms`. Once INVALID, it needs every second frame to become VALID again.
E2eReceiverParameters parameters_of(const Message& message) {
  const Duration cycle = std::chrono::milliseconds(message.cycle_ms);
  if (message.cycle_ms > kOdometryCycleMs) return gnss_receiver_parameters(cycle);
  return {.cycle = cycle};
}

template <size_t... I>
std::array<E2eMonitor, sizeof...(I)> monitors_of(const auto& messages, std::index_sequence<I...>) {
  return {E2eMonitor(highest_counter(messages[I]->protection().profile),
                     parameters_of(*messages[I]))...};
}

/// A sigma of 0 on the bus means less than one step, because no measurement is exact.
double at_least_one_step(double sigma, const Signal& signal) {
  return std::max(sigma, signal.scale);
}

}  // namespace

VehicleInput::VehicleInput(const BaseIds& base, GeodeticPosition map_origin, double rear_track_m)
    : base_(base),
      maker_(map_origin, rear_track_m, std::chrono::milliseconds(kOdometryCycleMs)),
      monitors_(monitors_of(kInputs, std::make_index_sequence<kInputs.size()>())),
      odometry_group_(window_of(kOdometryCycleMs)),
      gnss_group_(window_of(kGnssCycleMs)) {}

VehicleSamples VehicleInput::accept(const ReceivedFrame& received) {
  maker_.note_frame(received.received);
  const auto input = std::ranges::find_if(
      kInputs, [&](const Message* message) { return message->id(base_) == received.frame.id; });
  if (input == kInputs.end()) {
    maker_.note_unknown(received.frame, base_);
    return {};
  }
  const auto index = static_cast<size_t>(input - kInputs.begin());
  const E2eFrame checked = e2e_frame_of(received.frame, (*input)->protection(), (*input)->length);
  if (!maker_.accept(monitors_[index], checked, index < kFirstGnss)) return {};

  const auto epoch = static_cast<uint8_t>(extract_raw(received.frame, kEpoch));
  if (index < kFirstGnss) {
    const auto set = odometry_group_.add(index, epoch, received);
    return {.odometry = set ? odometry_from(*set) : std::nullopt};
  }
  const auto set = gnss_group_.add(index - kFirstGnss, epoch, received);
  return {.gnss = set ? gnss_from(*set) : std::nullopt};
}

std::optional<OdometrySample> VehicleInput::odometry_from(const EpochGroup<2>::Set& set) {
  const auto& [wheels, motion] = set.frames;
  const auto left_mps = decode(wheels, veh_wheel_speed::kRearLeft);
  const auto right_mps = decode(wheels, veh_wheel_speed::kRearRight);
  const auto yaw_rate_degps = decode(motion, veh_yaw_rate::kYawRate);
  if (!left_mps || !right_mps || !yaw_rate_degps) {
    ++counters_.not_available;
    return std::nullopt;
  }
  return maker_.odometry({.time = set.received,
                          .left_mps = *left_mps,
                          .right_mps = *right_mps,
                          .yaw_rate_radps = radians(*yaw_rate_degps)});
}

std::optional<GnssSample> VehicleInput::gnss_from(const EpochGroup<3>::Set& set) {
  const auto& [latitude, longitude, heading] = set.frames;
  const auto latitude_deg = decode(latitude, veh_gnss_latitude::kLatitude);
  const auto longitude_deg = decode(longitude, veh_gnss_longitude::kLongitude);
  const auto sigma_north_m = decode(latitude, veh_gnss_latitude::kStdDev);
  const auto sigma_east_m = decode(longitude, veh_gnss_longitude::kStdDev);
  if (!latitude_deg || !longitude_deg || !sigma_north_m || !sigma_east_m) {
    ++counters_.not_available;
    return std::nullopt;
  }
  const auto heading_deg = decode(heading, veh_gnss_heading::kHeading);
  const auto sigma_heading_deg = decode(heading, veh_gnss_heading::kStdDev);
  GeodeticFix fix{.position = {*latitude_deg, *longitude_deg},
                  .sigma_north_m = at_least_one_step(*sigma_north_m, veh_gnss_latitude::kStdDev),
                  .sigma_east_m = at_least_one_step(*sigma_east_m, veh_gnss_longitude::kStdDev)};
  if (heading_deg && sigma_heading_deg) {
    fix.heading = {*heading_deg, at_least_one_step(*sigma_heading_deg, veh_gnss_heading::kStdDev)};
  }
  return maker_.gnss(fix, set.received);
}

VehicleInputCounters VehicleInput::counters() const {
  VehicleInputCounters total = counters_;
  for (const E2eMonitor& monitor : monitors_) total.add(monitor.counters());
  maker_.add_to(total);
  total.incomplete = odometry_group_.incomplete() + gnss_group_.incomplete();
  return total;
}

std::vector<uint32_t> VehicleInput::accepted_ids(const BaseIds& base, bool secoc) {
  std::vector<uint32_t> ids;
  for (const Message* message : kMessages) {
    const bool is_accepted =
        message->sender == Sender::kVehicle && (secoc || !is_secoc_message(*message));
    if (is_accepted) ids.push_back(message->id(base));
  }
  return ids;
}

}  // namespace bevloc::can
