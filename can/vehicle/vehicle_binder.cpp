#include "can/vehicle/vehicle_binder.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "can/dbc/near_name.h"
#include "common/number_text.h"

namespace bevloc::can {
namespace {

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

/// The values that a plausible signal of a quantity reaches, in the unit of the quantity.
struct Sanity {
  /// The signal must reach this value, otherwise its unit is probably wrong. Not checked if 0.
  double reaches;
  double step;  ///< the largest step
  /// A signal of a speed or yaw rate has a sign if it reaches this value. It is 0 for the other
  /// quantities, whose signals may also be all positive or all negative.
  double negative = 0.0;
};
Sanity sanity_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kSpeed:
      return {15.0, 0.3, kSignedSpeed_mps};
    case Quantity::kYawRate:
      return {0.3, 0.02, kSignedYawRate_radps};
    case Quantity::kPosition:
      return {1.0, 1e-5};
    case Quantity::kHeading:
      return {1.0, 1.0};
    case Quantity::kHeadingSigma:
      return {0.0, 1.0};
    case Quantity::kLength:
      return {0.0, 2.0};
  }
  return {0.0, 0.0};
}

std::string_view unit_inside(Quantity quantity) {
  switch (quantity) {
    case Quantity::kSpeed:
      return "m/s";
    case Quantity::kYawRate:
      return "rad/s";
    case Quantity::kPosition:
    case Quantity::kHeading:
    case Quantity::kHeadingSigma:
      return "deg";
    case Quantity::kLength:
      return "m";
  }
  return "";
}

// The lowest and the highest value that the layout and the range of a signal allow.

double lowest_of(const DbcSignal& signal) {
  const double lowest = lowest_physical(signal.layout);
  return signal.has_range() ? std::max(lowest, signal.min) : lowest;
}

double highest_of(const DbcSignal& signal) {
  const double highest = highest_physical(signal.layout);
  return signal.has_range() ? std::min(highest, signal.max) : highest;
}

/// Whether a signal of this quantity has a sign.
bool has_sign(const DbcSignal& signal, Quantity quantity, double factor) {
  const double negative = sanity_of(quantity).negative;
  return negative < 0.0 && lowest_of(signal) * factor <= negative;
}

/// Refuses what is probably a wrong unit or a wrong signal. A quantity with a sign must reach
/// Sanity::reaches on the positive side, because its signal may be a magnitude. Other quantities
/// may reach it on either side.
Bound<void> check_range(const DbcSignal& signal, Quantity quantity, double factor) {
  const Sanity sanity = sanity_of(quantity);
  const double highest = highest_of(signal);
  const double farthest =
      sanity.negative < 0.0 ? highest : std::max(std::abs(lowest_of(signal)), std::abs(highest));
  const double reaches = farthest * factor;
  const std::string_view inside = unit_inside(quantity);
  if (reaches < sanity.reaches) {
    return refusal(
        fmt::format("{}, which reaches {:.4g} {} at most", signal.name, reaches, inside),
        fmt::format("a signal that reaches {} {}; check its unit", sanity.reaches, inside));
  }
  const double step = std::abs(signal.layout.scale) * factor;
  if (is_integer(signal.layout) && step > sanity.step) {
    return refusal(fmt::format("{} in steps of {:.4g} {}", signal.name, step, inside),
                   fmt::format("steps of at most {} {}; check its unit", sanity.step, inside));
  }
  return {};
}

/// Returns the raw values that a value of a condition means.
Bound<std::vector<int64_t>> raw_values_of(const std::string& text, const DbcSignal& signal) {
  std::vector<int64_t> values = signal.values_named(text);
  if (values.empty()) {
    const auto number = parse_number<int64_t>(text);
    if (!number) {
      return refusal(
          text + meant(text, names_in(signal.value_names)),
          fmt::format("a raw value of signal {} or a name that VAL_ gives it", signal.name),
          "values");
    }
    values.push_back(*number);
  }
  SignalLayout unscaled = signal.layout;
  unscaled.scale = 1.0;
  unscaled.offset = 0.0;
  for (const int64_t raw : values) {
    const auto number = static_cast<double>(raw);
    if (number < lowest_physical(unscaled) || number > highest_physical(unscaled)) {
      return refusal(text,
                     fmt::format("a raw value that fits into the {} bits of {}",
                                 signal.layout.length_bits, signal.name),
                     "values");
    }
  }
  return values;
}

bool fits(uint64_t value, const SignalLayout& layout) {
  return layout.length_bits == 64 || value >> layout.length_bits == 0;
}

/// Refuses a signal unless all frames have it, or all frames with one value of the only
/// multiplexor.
Bound<void> check_multiplexing(const DbcSignal& signal, const DbcMessage& message) {
  if (signal.multiplexed_at.empty()) return {};
  if (message.nested_multiplexing) {
    return refusal(fmt::format("{} behind several multiplexors", signal.name),
                   "a signal with one multiplexor or none");
  }
  const DbcValueRange& values = signal.multiplexed_at.front();
  const DbcSignal& multiplexor = *message.multiplexor();
  if (signal.multiplexed_at.size() > 1 || values.first != values.last) {
    return refusal(
        fmt::format("{} at several values of {}", signal.name, multiplexor.name),
        fmt::format("a signal that frames have at one value of {}, or always", multiplexor.name));
  }
  if (!fits(values.first, multiplexor.layout)) {
    return refusal(fmt::format("{}, which is multiplexed at {}", signal.name, values.first),
                   fmt::format("a value that fits into the {} bits of {}",
                               multiplexor.layout.length_bits, multiplexor.name));
  }
  return {};
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
  if (!message->left_out.empty()) {
    return refusal(fmt::format("{}, which is left out ({})", name, message->left_out),
                   "a message without mistakes");
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
  if (auto good = check_multiplexing(*found, *message); !good) return tl::unexpected(good.error());
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
                               .cycle = from_milliseconds(message.cycle_ms().value_or(0.0)),
                               .protection = {}});
  return binding_.messages.size() - 1;
}

size_t VehicleBinder::bind(const DbcMessage& message, const DbcSignal& signal) {
  BoundSignal bound{.name = fmt::format("{}.{}", message.name, signal.name),
                    .message = bind_message(message),
                    .layout = signal.layout,
                    .multiplexed = {},
                    .available = signal.available_values()};
  const auto known = std::ranges::find(binding_.signals, bound.name, &BoundSignal::name);
  if (known != binding_.signals.end()) {
    return static_cast<size_t>(known - binding_.signals.begin());
  }
  if (!signal.multiplexed_at.empty()) {
    bound.multiplexed = {message.multiplexor()->layout, signal.multiplexed_at.front().first};
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
  const auto index = bind(*message, **found);
  const auto other = quantities_.find(index);
  const bool both_lengths =
      quantity == Quantity::kLength && other != quantities_.end() && other->second == quantity;
  if (other != quantities_.end() && !both_lengths) {
    return refusal(fmt::format("{} for a second value", binding_.signals[index].name),
                   "a signal for each value");
  }
  quantities_.emplace(index, quantity);
  binding_.signals[index].factor = *factor;
  binding_.signals[index].has_sign = has_sign(**found, quantity, *factor);
  return index;
}

Bound<BoundCondition> VehicleBinder::condition(const std::string& signal,
                                               const std::string& default_message,
                                               const std::vector<std::string>& values) {
  const DbcMessage* message = nullptr;
  const auto found = find(signal, default_message, message);
  if (!found) return tl::unexpected(found.error());
  if (!is_integer((*found)->layout)) {
    return refusal(fmt::format("{}, which is a float", (*found)->name),
                   "a signal with whole numbers");
  }
  BoundCondition condition;
  for (const std::string& text : values) {
    const auto raw = raw_values_of(text, **found);
    if (!raw) return tl::unexpected(raw.error());
    condition.values.insert(condition.values.end(), raw->begin(), raw->end());
  }
  condition.signal = bind(*message, **found);
  return condition;
}

}  // namespace bevloc::can
