#include "can/messages/vehicle_input.h"

#include <algorithm>
#include <utility>

namespace bevloc::can {
namespace {

/// Long enough for a busy bus, and short compared with the 16 cycles after which an epoch repeats.
constexpr Duration window_of(int cycle_ms) {
  return std::chrono::milliseconds(4 * cycle_ms);
}

template <size_t... I>
std::array<E2eChecker, sizeof...(I)> checkers_of(const auto& messages, std::index_sequence<I...>) {
  return {E2eChecker(messages[I]->protection(), messages[I]->length)...};
}

/// A sigma of 0 on the bus means less than one step, because no measurement is exact.
double at_least_one_step(double sigma, const Signal& signal) {
  return std::max(sigma, signal.scale);
}

}  // namespace

VehicleInput::VehicleInput(const BaseIds& base, GeodeticPosition map_origin)
    : base_(base),
      geo_(map_origin),
      checkers_(checkers_of(kInputs, std::make_index_sequence<kInputs.size()>())),
      odometry_group_(window_of(kOdometryCycleMs)),
      gnss_group_(window_of(kGnssCycleMs)) {}

std::optional<VehicleSample> VehicleInput::accept(const ReceivedFrame& received) {
  const auto input = std::ranges::find_if(
      kInputs, [&](const Message* message) { return message->id(base_) == received.frame.id; });
  if (input == kInputs.end()) {
    ++counters_.foreign;
    return std::nullopt;
  }
  const auto index = static_cast<size_t>(input - kInputs.begin());
  if (!is_usable(checkers_[index].check(received.frame))) return std::nullopt;

  const auto epoch = static_cast<uint8_t>(extract_raw(received.frame, kEpoch));
  if (index < kFirstGnss) {
    const auto set = odometry_group_.add(index, epoch, received);
    return set ? odometry_from(*set) : std::nullopt;
  }
  const auto set = gnss_group_.add(index - kFirstGnss, epoch, received);
  return set ? gnss_from(*set) : std::nullopt;
}

std::optional<VehicleSample> VehicleInput::odometry_from(const EpochGroup<2>::Set& set) {
  const auto& [wheels, motion] = set.frames;
  const auto left_mps = decode(wheels, veh_wheel_speed::kRearLeft);
  const auto right_mps = decode(wheels, veh_wheel_speed::kRearRight);
  const auto yaw_rate_degps = decode(motion, veh_yaw_rate::kYawRate);
  if (!left_mps || !right_mps || !yaw_rate_degps) {
    ++counters_.not_available;
    return std::nullopt;
  }
  ++counters_.odometry_samples;
  last_odometry_ = set.received;
  return OdometrySample{.time = set.received,
                        .speed_mps = 0.5 * (*left_mps + *right_mps),
                        .yaw_rate_radps = radians(*yaw_rate_degps)};
}

std::optional<VehicleSample> VehicleInput::gnss_from(const EpochGroup<3>::Set& set) {
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
  const Se2 map_from_vehicle =
      geo_.map_from_geodetic({{*latitude_deg, *longitude_deg}, heading_deg.value_or(0.0)});

  GnssSample sample{.time = set.received,
                    .east_m = map_from_vehicle.x_m,
                    .north_m = map_from_vehicle.y_m,
                    .sigma_east_m = at_least_one_step(*sigma_east_m, veh_gnss_longitude::kStdDev),
                    .sigma_north_m = at_least_one_step(*sigma_north_m, veh_gnss_latitude::kStdDev)};
  if (heading_deg && sigma_heading_deg) {
    const double sigma_deg = at_least_one_step(*sigma_heading_deg, veh_gnss_heading::kStdDev);
    sample.yaw = {map_from_vehicle.yaw_rad, radians(sigma_deg)};
  }
  ++counters_.gnss_samples;
  last_gnss_ = set.received;
  return sample;
}

VehicleInputCounters VehicleInput::counters() const {
  VehicleInputCounters total = counters_;
  for (const E2eChecker& checker : checkers_) {
    total.wrong_crc += checker.counters().wrong_crc;
    total.wrong_length += checker.counters().wrong_length;
    total.repeated += checker.counters().repeated;
    total.lost += checker.counters().lost;
  }
  total.incomplete = odometry_group_.incomplete() + gnss_group_.incomplete();
  return total;
}

std::vector<uint32_t> VehicleInput::accepted_ids(const BaseIds& base) {
  std::vector<uint32_t> ids(kInputs.size());
  std::ranges::transform(kInputs, ids.begin(),
                         [&](const Message* message) { return message->id(base); });
  return ids;
}

}  // namespace bevloc::can
