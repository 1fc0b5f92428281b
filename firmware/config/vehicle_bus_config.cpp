#include "firmware/config/vehicle_bus_config.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "can/dbc/signal_layout.h"
#include "can/messages/message_table.h"
#include "can/vehicle/vehicle_binder.h"

namespace bevloc::firmware {
namespace {

using can::Bound;
using can::Quantity;
using can::WheelPlace;

const Wanted<std::string>& some_name() {
  static const Wanted<std::string> wanted{"a name",
                                          [](const std::string& name) { return !name.empty(); }};
  return wanted;
}

/// Rejects the key that the refusal names, or `first_key`.
void reject(YamlMap& yaml, std::string_view first_key, const can::Refusal& refusal) {
  yaml.reject(refusal.key.empty() ? first_key : refusal.key, refusal.found, refusal.wanted);
}

/// One group of signals (wheel_speed, yaw_rate or gnss) and the message that they are in. If there
/// is no DBC file, there is no binder. Then the keys are read, but nothing is bound.
class SignalGroup {
 public:
  SignalGroup(YamlMap yaml, can::VehicleBinder* binder) : yaml_(std::move(yaml)), binder_(binder) {
    const auto name = yaml_.require<std::string>("message", some_name());
    if (name.empty() || binder_ == nullptr) return;
    const auto known = binder_->message_name(name);
    if (known) message_ = *known;
    if (!known) refuse("message", known.error());
  }

  /// Returns the index of the signal that `key` of `yaml` names. After a mistake the index is not
  /// used.
  size_t signal(YamlMap& yaml, std::string_view key, Quantity quantity, const std::string& unit) {
    const auto name = yaml.require<std::string>(key, some_name());
    if (message_.empty() || name.empty()) return 0;
    return take(binder_->quantity(name, message_, quantity, unit), yaml, key);
  }
  size_t signal(std::string_view key, Quantity quantity, const std::string& unit) {
    return signal(yaml_, key, quantity, unit);
  }
  std::optional<size_t> optional_signal(std::string_view key, Quantity quantity,
                                        const std::string& unit) {
    if (!yaml_.has(key)) return std::nullopt;
    return signal(key, quantity, unit);
  }

  /// Whether a bound signal has a sign. Returns true for a signal that is not bound.
  bool has_sign(size_t signal) const {
    if (message_.empty() || signal >= binder_->binding().signals.size()) return true;
    return binder_->binding().signals[signal].has_sign;
  }

  /// Reads `{signal: NAME, values: [A, B]}`.
  std::optional<can::BoundCondition> condition(std::string_view key) {
    auto yaml = yaml_.optional_map(key);
    if (!yaml) return std::nullopt;
    const auto name = yaml->require<std::string>("signal", some_name());
    const auto values = yaml->require_list<std::string>("values", 0, some_name());
    if (values.empty()) yaml->reject("values", "no value", "one value or more");
    if (message_.empty() || name.empty()) return can::BoundCondition{};
    auto bound = binder_->condition(name, message_, values);
    if (bound) return std::move(*bound);
    reject(*yaml, "signal", bound.error());
    return can::BoundCondition{};
  }

  std::string unit(std::string_view key) { return yaml_.optional<std::string>(key, ""); }
  YamlMap& yaml() { return yaml_; }
  void refuse(std::string_view key, const can::Refusal& refusal) {
    yaml_.reject(key, refusal.found, refusal.wanted);
  }

 private:
  static size_t take(const Bound<size_t>& bound, YamlMap& yaml, std::string_view key) {
    if (bound) return *bound;
    yaml.reject(key, bound.error().found, bound.error().wanted);
    return 0;
  }

  YamlMap yaml_;
  can::VehicleBinder* binder_;  ///< null without a DBC file
  std::string message_;
};

can::BoundWheels read_wheels(YamlMap yaml, can::VehicleBinder* binder) {
  SignalGroup group(std::move(yaml), binder);
  can::BoundWheels wheels;
  const std::string unit = group.unit("unit");
  YamlMap signals = group.yaml().require_map("signals");
  const auto add = [&](std::string_view key, WheelPlace place) {
    if (!signals.has(key)) return false;
    wheels.wheels.push_back({group.signal(signals, key, Quantity::kSpeed, unit), place});
    return true;
  };
  const bool left = add("rear_left", WheelPlace::kRearLeft);
  const bool right = add("rear_right", WheelPlace::kRearRight);
  const bool front_left = add("front_left", WheelPlace::kFrontLeft);
  const bool front_right = add("front_right", WheelPlace::kFrontRight);
  const bool vehicle = add("vehicle", WheelPlace::kVehicle);
  if (!vehicle && !(left && right)) {
    group.yaml().reject("signals", "neither both rear wheels nor the vehicle's speed",
                        "rear_left and rear_right, or vehicle");
  }
  if (front_left || front_right) {
    if (group.yaml().has("wheelbase_m")) {
      wheels.wheelbase_m = group.yaml().require<double>("wheelbase_m", between(1.0, 8.0));
    } else {
      group.yaml().reject("signals", "front wheels without wheelbase_m",
                          "wheelbase_m, or the rear wheels alone");
    }
  }
  wheels.valid = group.condition("valid");
  wheels.backward = group.condition("backward");
  const bool have_signs = std::ranges::all_of(
      wheels.wheels, [&group](const auto& wheel) { return group.has_sign(wheel.signal); });
  if (!wheels.backward && !have_signs) {
    group.yaml().reject(
        "signals", fmt::format("speeds that do not reach {} m/s", can::kSignedSpeed_mps),
        "the key backward, which names the signal that says when the vehicle reverses");
  }
  return wheels;
}

can::BoundYawRate read_yaw_rate(YamlMap yaml, can::VehicleBinder* binder) {
  SignalGroup group(std::move(yaml), binder);
  can::BoundYawRate yaw_rate;
  yaw_rate.signal = group.signal("signal", Quantity::kYawRate, group.unit("unit"));
  yaw_rate.positive_right =
      group.yaml().optional_choice<bool>("positive", false, {{"left", false}, {"right", true}});
  yaw_rate.valid = group.condition("valid");
  yaw_rate.negative = group.condition("negative");
  if (!yaw_rate.negative && !group.has_sign(yaw_rate.signal)) {
    group.yaml().reject(
        "signal", fmt::format("a yaw rate that does not reach {} rad/s", can::kSignedYawRate_radps),
        "the key negative, which names the signal that says when the yaw rate is negative");
  }
  return yaw_rate;
}

/// Reads the sigma of a group: a number or signals, but not both.
void read_position_sigma(SignalGroup& group, can::BoundGnss& gnss) {
  const std::string unit = group.unit("sigma_unit");
  YamlMap& yaml = group.yaml();
  if (yaml.has("sigma_m")) gnss.sigma_m = yaml.require<double>("sigma_m", between(0.01, 100.0));
  if (auto both = group.optional_signal("sigma", Quantity::kLength, unit)) {
    gnss.sigma_north = gnss.sigma_east = both;
  }
  if (auto north = group.optional_signal("sigma_north", Quantity::kLength, unit)) {
    gnss.sigma_north = north;
  }
  if (auto east = group.optional_signal("sigma_east", Quantity::kLength, unit)) {
    gnss.sigma_east = east;
  }
  const int ways = (yaml.has("sigma_m") ? 1 : 0) + (yaml.has("sigma") ? 1 : 0) +
                   (yaml.has("sigma_north") || yaml.has("sigma_east") ? 1 : 0);
  if (ways != 1 || yaml.has("sigma_north") != yaml.has("sigma_east")) {
    yaml.reject("message", fmt::format("{} statements of the position's sigma", ways),
                "one of sigma_m, sigma, or sigma_north with sigma_east");
  }
}

void read_heading(SignalGroup& group, can::BoundGnss& gnss) {
  YamlMap& yaml = group.yaml();
  if (!yaml.has("heading")) return;
  const std::string unit = group.unit("heading_unit");
  gnss.heading = group.signal("heading", Quantity::kHeading, unit);
  gnss.heading_valid = group.condition("heading_valid");
  gnss.sigma_heading = group.optional_signal("sigma_heading", Quantity::kHeadingSigma, unit);
  if (yaml.has("sigma_heading_deg")) {
    gnss.sigma_heading_deg = yaml.require<double>("sigma_heading_deg", between(0.01, 90.0));
  }
  if (yaml.has("sigma_heading") == yaml.has("sigma_heading_deg")) {
    yaml.reject("heading", "both or none of sigma_heading and sigma_heading_deg", "one of them");
  }
}

can::BoundGnss read_gnss_signals(YamlMap yaml, can::VehicleBinder* binder) {
  SignalGroup group(std::move(yaml), binder);
  can::BoundGnss gnss;
  const std::string unit = group.unit("position_unit");
  gnss.latitude = group.signal("latitude", Quantity::kPosition, unit);
  gnss.longitude = group.signal("longitude", Quantity::kPosition, unit);
  gnss.valid = group.condition("valid");
  read_position_sigma(group, gnss);
  read_heading(group, gnss);
  return gnss;
}

void read_data_ids(YamlMap& yaml, can::ProtectionRequest& request) {
  const auto data_id = between(uint32_t{0}, uint32_t{0xFFFF});
  if (yaml.has("data_id")) {
    request.data_ids = {static_cast<uint16_t>(yaml.require<uint32_t>("data_id", data_id))};
  }
  if (yaml.has("data_ids")) {
    const auto ids = yaml.require_list<uint32_t>("data_ids", 16, data_id);
    request.data_ids.assign(ids.begin(), ids.end());
  }
  if (yaml.has("data_id") && yaml.has("data_ids")) {
    yaml.reject("data_ids", "data_id beside data_ids", "one of them");
  }
}

can::ProtectionRequest read_protection_request(YamlMap& yaml) {
  can::ProtectionRequest request;
  request.message = yaml.require<std::string>("message", some_name());
  if (yaml.has("cycle_ms")) request.cycle_ms = yaml.require<double>("cycle_ms", between(1.0, 5e3));
  const auto kind =
      yaml.optional_choice<can::ChecksumKind>("algorithm", can::ChecksumKind::kNone,
                                              {{"none", can::ChecksumKind::kNone},
                                               {"xor", can::ChecksumKind::kXor},
                                               {"crc8_sae_j1850", can::ChecksumKind::kCrc8Sae},
                                               {"crc8_h2f", can::ChecksumKind::kCrc8H2f},
                                               {"e2e_p02", can::ChecksumKind::kE2eP02},
                                               {"e2e_p05", can::ChecksumKind::kE2eP05}});
  if (yaml.has("algorithm")) request.kind = kind;
  const bool is_profile = kind == can::ChecksumKind::kE2eP02 || kind == can::ChecksumKind::kE2eP05;
  const bool has_checksum = kind != can::ChecksumKind::kNone && !is_profile;
  if (yaml.has("counter")) request.counter = yaml.require<std::string>("counter", some_name());
  if (yaml.has("checksum")) request.checksum = yaml.require<std::string>("checksum", some_name());
  if (yaml.has("highest_counter")) {
    request.highest_counter =
        yaml.require<uint32_t>("highest_counter", between(uint32_t{1}, uint32_t{255}));
  }
  if (yaml.has("checksum") != has_checksum) {
    yaml.reject("algorithm",
                has_checksum ? "no key checksum" : "the key checksum without its algorithm",
                "the key checksum if and only if algorithm is xor, crc8_sae_j1850 or crc8_h2f");
  }
  if (is_profile && (yaml.has("counter") || yaml.has("highest_counter"))) {
    yaml.reject("algorithm", "a profile that has its own counter, beside another counter",
                "neither the key counter nor highest_counter");
  }
  read_data_ids(yaml, request);
  return request;
}

/// Reads the table `protection`.
void read_protection(YamlMap& yaml, can::VehicleBinder* binder) {
  if (!yaml.has("protection")) return;
  for (YamlMap& entry : yaml.require_map_list("protection")) {
    const can::ProtectionRequest request = read_protection_request(entry);
    if (request.message.empty() || binder == nullptr) continue;
    if (const auto good = binder->protect(request); !good) {
      reject(entry, "message", good.error());
    }
  }
}

/// Refuses a DBC file with identifiers of the localizer's messages, so that nobody confuses the
/// frames.
void check_identifiers(YamlMap& yaml, const can::Dbc& dbc, const can::BaseIds& base) {
  for (const can::Message* own : can::kMessages) {
    if (own->sender != can::Sender::kLocalizer) continue;
    const can::DbcMessage* other = dbc.find(own->id(base), false);
    if (other == nullptr || other->name == own->name) continue;
    yaml.reject(
        "dbc",
        fmt::format("message {} with identifier {:#x} of {}", other->name, other->id, own->name),
        "another can.localizer_base_id");
  }
}

}  // namespace

std::string read_dbc_name(YamlMap& yaml) {
  return yaml.require<std::string>("dbc", some_name());
}

can::VehicleBinding read_vehicle_bus(YamlMap& yaml, const can::BaseIds& base,
                                     const std::filesystem::path& dbc_file) {
  const auto dbc = dbc_file.empty() ? Result<can::Dbc>() : can::read_dbc_file(dbc_file);
  if (!dbc) yaml.reject_file(dbc.error());
  const bool usable = !dbc_file.empty() && dbc;
  if (usable) check_identifiers(yaml, *dbc, base);
  const can::Dbc nothing;
  can::VehicleBinder binder(usable ? *dbc : nothing);
  can::VehicleBinder* usable_binder = usable ? &binder : nullptr;
  auto wheels = read_wheels(yaml.require_map("wheel_speed"), usable_binder);
  auto yaw_rate = read_yaw_rate(yaml.require_map("yaw_rate"), usable_binder);
  std::optional<can::BoundGnss> gnss;
  if (auto section = yaml.optional_map("gnss")) {
    gnss = read_gnss_signals(std::move(*section), usable_binder);
  }
  read_protection(yaml, usable_binder);
  binder.binding().wheels = std::move(wheels);
  binder.binding().yaw_rate = std::move(yaw_rate);
  if (gnss) binder.binding().gnss = std::move(*gnss);
  if (binder.binding().signals.empty()) return {};
  auto binding = binder.finish();
  if (binding) return std::move(*binding);
  const auto& refused = binding.error();
  yaml.reject("dbc", fmt::format("message {} with {}", refused.message, refused.refusal.found),
              refused.refusal.wanted);
  return {};
}

}  // namespace bevloc::firmware
