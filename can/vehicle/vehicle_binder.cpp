#include "can/vehicle/vehicle_binder.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "can/bus/frame.h"
#include "can/dbc/near_name.h"

namespace bevloc::can {
namespace {

constexpr double kSlowestOdometry_ms = 40.0;
constexpr double kSlowestGnss_ms = 2000.0;
constexpr double kFastest_ms = 1.0;

tl::unexpected<Refusal> refusal(std::string found, std::string wanted) {
  return tl::unexpected(Refusal{std::move(found), std::move(wanted)});
}

std::string meant(const std::string& name, const std::vector<std::string>& known) {
  const auto near = near_name(name, known);
  return near ? fmt::format(" (did you mean {}?)", *near) : "";
}

template <typename Named>
std::vector<std::string> names_in(const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  return names;
}

/// What any signal of a quantity reaches, and its coarsest step, in the unit of the quantity.
struct Sanity {
  double reaches;
  double step;
};
Sanity sanity_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kSpeed:
      return {15.0, 0.3};
    case Quantity::kYawRate:
      return {0.3, 0.02};
    case Quantity::kAngle:
      return {1.0, 1.0};
    case Quantity::kLength:
      return {0.5, 2.0};
  }
  return {0.0, 0.0};
}

std::string_view unit_inside(Quantity quantity) {
  switch (quantity) {
    case Quantity::kSpeed:
      return "m/s";
    case Quantity::kYawRate:
      return "rad/s";
    case Quantity::kAngle:
      return "deg";
    case Quantity::kLength:
      return "m";
  }
  return "";
}

/// Refuses what is probably a wrong unit or a wrong signal.
Bound<void> check_range(const DbcSignal& signal, Quantity quantity, double factor) {
  const Sanity sanity = sanity_of(quantity);
  const bool has_range = signal.min < signal.max;
  const double low = has_range ? signal.min : lowest_physical(signal.layout);
  const double high = has_range ? signal.max : highest_physical(signal.layout);
  const double reaches = std::max(std::abs(low), std::abs(high)) * factor;
  const std::string_view inside = unit_inside(quantity);
  if (reaches < sanity.reaches) {
    return refusal(
        fmt::format("{}, which reaches {:.4g} {} at most", signal.name, reaches, inside),
        fmt::format("a signal that reaches {} {}; check its unit", sanity.reaches, inside));
  }
  const bool is_integer =
      signal.layout.type == RawType::kUnsigned || signal.layout.type == RawType::kSigned;
  const double step = std::abs(signal.layout.scale) * factor;
  if (is_integer && step > sanity.step) {
    return refusal(fmt::format("{} in steps of {:.4g} {}", signal.name, step, inside),
                   fmt::format("steps of at most {} {}; check its unit", sanity.step, inside));
  }
  return {};
}

std::vector<int64_t> not_available_values(const DbcSignal& signal) {
  std::vector<int64_t> values;
  for (const DbcValueName& value : signal.value_names) {
    if (value.name == "SNA" || value.name == "sna") values.push_back(value.raw);
  }
  return values;
}

std::optional<int64_t> whole_number(const std::string& text) {
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Bound<size_t> checksum_byte_of(const DbcSignal& signal) {
  const SignalLayout& layout = signal.layout;
  const bool whole_byte = layout.length_bits == 8 &&
                          layout.start_bit % 8 == (layout.order == ByteOrder::kIntel ? 0 : 7);
  if (whole_byte) return static_cast<size_t>(layout.start_bit / 8);
  return refusal(fmt::format("checksum {} with {} bits from bit {}", signal.name,
                             layout.length_bits, layout.start_bit),
                 "a whole byte");
}

/// "P02", "Profile 2", "E2E_P05": the last number of the text.
int profile_number(const std::string& text) {
  const size_t end = text.find_last_of("0123456789");
  if (end == std::string::npos) return 0;
  size_t begin = end;
  while (begin > 0 && text[begin - 1] >= '0' && text[begin - 1] <= '9') --begin;
  int number = 0;
  std::from_chars(text.data() + begin, text.data() + end + 1, number);
  return number;
}

}  // namespace

Bound<std::string> VehicleBinder::message_name(const std::string& name) const {
  const DbcMessage* message = dbc_.find(name);
  if (message == nullptr) {
    return refusal(name + meant(name, names_in(dbc_.messages)),
                   fmt::format("the name of a message of {}", dbc_.file));
  }
  if (message->is_extended) {
    return refusal(fmt::format("{} with the 29-bit identifier {:#x}", name, message->id),
                   "one with 11 bits, which bevloc receives");
  }
  return name;
}

Bound<const DbcSignal*> VehicleBinder::find(const std::string& signal,
                                            const std::string& default_message,
                                            const DbcMessage*& message) const {
  const size_t point = signal.find('.');
  const bool has_message = point != std::string::npos;
  const std::string name = has_message ? signal.substr(point + 1) : signal;
  const auto known = message_name(has_message ? signal.substr(0, point) : default_message);
  if (!known) return tl::unexpected(known.error());
  message = dbc_.find(*known);
  const DbcSignal* found = message->find(name);
  if (found == nullptr) {
    return refusal(
        name + meant(name, names_in(message->signals)),
        fmt::format("the name of a signal of message {} of {}", message->name, dbc_.file));
  }
  if (found->multiplexed_at && message->nested_multiplexing) {
    return refusal(fmt::format("{} behind several multiplexors", name),
                   "a signal with one multiplexor or none");
  }
  return found;
}

size_t VehicleBinder::bind_message(const DbcMessage& message) {
  const auto bound = std::ranges::find(binding_.messages, message.name, &BoundMessage::name);
  if (bound != binding_.messages.end()) {
    return static_cast<size_t>(bound - binding_.messages.begin());
  }
  binding_.messages.push_back({.name = message.name,
                               .id = message.id,
                               .length = message.length,
                               .cycle = from_seconds(1e-3 * message.cycle_ms().value_or(0.0)),
                               .protection = {}});
  return binding_.messages.size() - 1;
}

Bound<size_t> VehicleBinder::bind(const DbcMessage& message, const DbcSignal& signal,
                                  double factor) {
  BoundSignal bound{.name = fmt::format("{}.{}", message.name, signal.name),
                    .message = bind_message(message),
                    .layout = signal.layout,
                    .multiplexed = {},
                    .min = signal.min,
                    .max = signal.max,
                    .not_available = not_available_values(signal),
                    .factor = factor};
  const auto known = std::ranges::find(binding_.signals, bound.name, &BoundSignal::name);
  if (known != binding_.signals.end()) {
    return static_cast<size_t>(known - binding_.signals.begin());
  }
  if (signal.min == signal.max) {
    bound.min = -std::numeric_limits<double>::infinity();
    bound.max = std::numeric_limits<double>::infinity();
  } else {
    // Limits that are written with few digits must not refuse the value beside them.
    const double half_step = 0.5 * std::abs(signal.layout.scale);
    bound.min -= half_step;
    bound.max += half_step;
  }
  if (signal.multiplexed_at) {
    bound.multiplexed = {message.multiplexor()->layout, *signal.multiplexed_at};
  }
  binding_.signals.push_back(std::move(bound));
  return binding_.signals.size() - 1;
}

Bound<size_t> VehicleBinder::quantity(const std::string& signal, const std::string& default_message,
                                      Quantity quantity, const std::string& unit) {
  const DbcMessage* message = nullptr;
  const auto found = find(signal, default_message, message);
  if (!found) return tl::unexpected(found.error());
  const std::string& used_unit = unit.empty() ? (*found)->unit : unit;
  const auto factor = factor_of_unit(quantity, used_unit);
  if (!factor) {
    return refusal(fmt::format("{} with unit \"{}\"", (*found)->name, used_unit),
                   fmt::format("{}; state the unit in the configuration", units_of(quantity)));
  }
  if (auto good = check_range(**found, quantity, *factor); !good) {
    return tl::unexpected(good.error());
  }
  return bind(*message, **found, *factor);
}

Bound<BoundCondition> VehicleBinder::condition(const std::string& signal,
                                               const std::string& default_message,
                                               const std::vector<std::string>& values) {
  const DbcMessage* message = nullptr;
  const auto found = find(signal, default_message, message);
  if (!found) return tl::unexpected(found.error());
  const SignalLayout& layout = (*found)->layout;
  BoundCondition condition;
  for (const std::string& text : values) {
    auto raw = whole_number(text);
    if (const DbcValueName* named = (*found)->find_value(text)) raw = named->raw;
    if (!raw) {
      return refusal(
          text + meant(text, names_in((*found)->value_names)),
          fmt::format("a raw value of signal {} or a name that VAL_ gives it", (*found)->name));
    }
    SignalLayout unscaled = layout;
    unscaled.scale = 1.0;
    unscaled.offset = 0.0;
    const auto number = static_cast<double>(*raw);
    if (number < lowest_physical(unscaled) || number > highest_physical(unscaled)) {
      return refusal(text, fmt::format("a raw value that fits into the {} bits of {}",
                                       layout.length_bits, (*found)->name));
    }
    condition.values.push_back(*raw);
  }
  const auto bound = bind(*message, **found, 1.0);
  if (!bound) return tl::unexpected(bound.error());
  condition.signal = *bound;
  return condition;
}

Bound<void> VehicleBinder::protect(const ProtectionRequest& request) {
  const auto name = message_name(request.message);
  if (!name) return tl::unexpected(name.error());
  const auto bound = std::ranges::find(binding_.messages, *name, &BoundMessage::name);
  if (bound == binding_.messages.end()) {
    return refusal(*name, "a message that odometry or GNSS uses");
  }
  if (request.cycle_ms) bound->cycle = from_seconds(1e-3 * *request.cycle_ms);
  MessageProtection& protection = bound->protection;
  protection.checksum = request.kind;
  protection.data_ids = request.data_ids;
  const bool is_profile = protection.is_profile();
  const DbcMessage* message = nullptr;
  if (is_profile) {
    const size_t ids = request.kind == ChecksumKind::kE2eP02 ? 16 : 1;
    if (protection.data_ids.size() != 1 && protection.data_ids.size() != ids) {
      return refusal(fmt::format("{} data ids", protection.data_ids.size()),
                     "data_id, or 16 data_ids for profile P02");
    }
  }
  if (!request.counter.empty()) {
    const auto counter = find(request.counter, *name, message);
    if (!counter) return tl::unexpected(counter.error());
    const int bits = (*counter)->layout.length_bits;
    if (bits > 8) return refusal(fmt::format("a counter with {} bits", bits), "at most 8 bits");
    protection.counter = (*counter)->layout;
    const uint32_t highest = (1U << bits) - 1;
    protection.highest_counter = static_cast<uint8_t>(request.highest_counter.value_or(highest));
    if (protection.highest_counter > highest) {
      return refusal(fmt::format("highest counter {}", protection.highest_counter),
                     fmt::format("at most {}", highest));
    }
  }
  if (!request.checksum.empty()) {
    const auto checksum = find(request.checksum, *name, message);
    if (!checksum) return tl::unexpected(checksum.error());
    const auto byte = checksum_byte_of(**checksum);
    if (!byte) return tl::unexpected(byte.error());
    protection.checksum_byte = *byte;
  }
  requests_.push_back(request);
  return {};
}

Bound<void> VehicleBinder::protect_by_attributes(const DbcMessage& dbc,
                                                 BoundMessage& message) const {
  const auto profile = dbc.attributes.find("E2EProfile");
  const auto data_id = dbc.attributes.find("E2EDataId");
  if (profile == dbc.attributes.end() || data_id == dbc.attributes.end()) return {};
  const int number = profile_number(profile->second);
  if (number == 0) return {};  // "none"
  if (number != 2 && number != 5) {
    return refusal(fmt::format("E2EProfile {}", profile->second),
                   "P02 or P05, or an entry for this message in protection");
  }
  const auto id = whole_number(data_id->second);
  if (!id || *id < 0 || *id > UINT16_MAX) {
    return refusal(fmt::format("E2EDataId {}", data_id->second), "0 to 65535");
  }
  message.protection.checksum = number == 2 ? ChecksumKind::kE2eP02 : ChecksumKind::kE2eP05;
  message.protection.data_ids = {static_cast<uint16_t>(*id)};
  return {};
}

void VehicleBinder::mark_odometry() {
  const auto mark = [this](size_t signal) {
    binding_.messages[binding_.signals[signal].message].has_odometry = true;
  };
  for (const BoundWheels::Wheel& wheel : binding_.wheels.wheels) mark(wheel.signal);
  mark(binding_.yaw_rate.signal);
}

Bound<void> VehicleBinder::finish_message(BoundMessage& message) {
  const bool requested = std::ranges::any_of(
      requests_, [&](const auto& request) { return request.message == message.name; });
  if (!requested) {
    auto protection = protect_by_attributes(*dbc_.find(message.name), message);
    if (!protection) return protection;
  }
  if (message.protection.is_profile()) {
    const uint8_t header = message.protection.checksum == ChecksumKind::kE2eP02 ? 2 : 3;
    if (message.length < header) {
      return refusal(fmt::format("{} bytes", message.length), "room for checksum and counter");
    }
  }
  if (message.protection.checksum == ChecksumKind::kE2eP05) {
    message.protection.highest_counter = UINT8_MAX;
  }
  const double cycle_ms = 1e3 * to_seconds(message.cycle);
  if (cycle_ms == 0.0) {
    return refusal("no cycle time (attribute GenMsgCycleTime)",
                   "one, or cycle_ms for this message in protection");
  }
  const double slowest_ms = message.has_odometry ? kSlowestOdometry_ms : kSlowestGnss_ms;
  if (cycle_ms < kFastest_ms || cycle_ms > slowest_ms) {
    return refusal(fmt::format("a cycle of {:g} ms", cycle_ms),
                   fmt::format("{:g} to {:g} ms for {}", kFastest_ms, slowest_ms,
                               message.has_odometry ? "odometry" : "GNSS and conditions"));
  }
  return {};
}

tl::expected<VehicleBinding, VehicleBinder::MessageRefusal> VehicleBinder::finish() {
  mark_odometry();
  for (BoundMessage& message : binding_.messages) {
    if (auto good = finish_message(message); !good) {
      return tl::unexpected(MessageRefusal{message.name, good.error()});
    }
  }
  return std::move(binding_);
}

}  // namespace bevloc::can
