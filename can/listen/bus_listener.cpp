#include "can/listen/bus_listener.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "can/messages/dbc_writer.h"
#include "can/messages/message_table.h"
#include "common/json_dump.h"

namespace bevloc::can {
namespace {

/// Bevloc's own messages as a DBC file.
Dbc own_dbc(const BaseIds& base) {
  assert(base.are_apart());
  auto dbc = parse_dbc(dbc_text(base), "bevloc");
  assert(dbc);
  return std::move(*dbc);
}

const Message* own_message(std::string_view name, uint32_t id, const BaseIds& base) {
  const auto found = std::ranges::find_if(kMessages, [&](const Message* message) {
    return message->name == name && message->id(base) == id;
  });
  return found == std::end(kMessages) ? nullptr : *found;
}

bool is_present(const DbcMessage& message, const DbcSignal& signal,
                std::span<const uint8_t> bytes) {
  if (signal.multiplexed_at.empty()) return true;
  if (message.nested_multiplexing) return false;
  const SignalLayout& multiplexor = message.multiplexor()->layout;
  return bytes_needed(multiplexor) <= bytes.size() &&
         signal.is_present_at(raw_bits_from(multiplexor, bytes));
}

DecodedSignal decoded(const DbcSignal& signal, const AvailableValues& available,
                      std::span<const uint8_t> bytes) {
  DecodedSignal result{.signal = &signal,
                       .value = physical_from(signal.layout, bytes),
                       .raw = raw_from(signal.layout, bytes)};
  const auto named = std::ranges::find(signal.value_names, result.raw, &DbcValueName::raw);
  if (named != signal.value_names.end()) result.value_name = named->name;
  result.is_available = available.has(result.raw, result.value);
  return result;
}

/// Whether the value of the signal is its raw value, which a double may not hold exactly.
bool is_raw(const SignalLayout& layout) {
  return is_integer(layout) && layout.scale == 1.0 && layout.offset == 0.0;
}

std::string number_text(const DecodedSignal& decoded) {
  const SignalLayout& layout = decoded.signal->layout;
  if (is_raw(layout) && layout.type == RawType::kUnsigned) {
    return fmt::format("{}", static_cast<uint64_t>(decoded.raw));
  }
  if (is_raw(layout)) return fmt::format("{}", decoded.raw);
  constexpr double kLarge = 1e6;
  constexpr double kExact = 9007199254740992.0;  // 2^53
  const double value = decoded.value;
  const bool is_whole = std::abs(value) < kExact && value == std::trunc(value);
  if (is_whole && std::abs(value) >= kLarge) return fmt::format("{:.0f}", value);
  // Further digits of a small value may come from rounding only.
  return fmt::format("{:.{}g}", value, std::abs(value) < kLarge ? 10 : 15);
}

nlohmann::ordered_json json_value(const DecodedSignal& decoded) {
  const SignalLayout& layout = decoded.signal->layout;
  if (!decoded.is_available) return nullptr;
  if (!is_raw(layout)) return decoded.value;
  if (layout.type == RawType::kUnsigned) return static_cast<uint64_t>(decoded.raw);
  return decoded.raw;
}

}  // namespace

BusListener::BusListener(std::vector<Dbc> files, const BaseIds& base) : files_(std::move(files)) {
  files_.push_back(own_dbc(base));
  for (const Dbc& file : files_) {
    for (const DbcMessage& message : file.messages) {
      if (message.is_extended) continue;
      Known known{.message = &message};
      for (const DbcSignal& signal : message.signals) {
        known.available.push_back(signal.available_values());
      }
      known.own = own_message(message.name, message.id, base);
      known_.emplace(message.id, known);
    }
  }
}

bool BusListener::knows(std::string_view message) const {
  return std::ranges::any_of(files_, [&](const Dbc& file) {
    const DbcMessage* found = file.find(message);
    return found != nullptr && found->left_out.empty();
  });
}

void BusListener::add_signals(const Known& known, std::span<const uint8_t> bytes) {
  for (size_t i = 0; i < known.available.size(); ++i) {
    const DbcSignal& signal = known.message->signals[i];
    const bool fits = bytes_needed(signal.layout) <= bytes.size();
    if (fits && is_present(*known.message, signal, bytes)) {
      decoded_.signals.push_back(decoded(signal, known.available[i], bytes));
    }
  }
}

E2eResult BusListener::check(const Frame& frame, std::string_view interface, Known& known) {
  auto checker = known.checkers.find(interface);
  if (checker == known.checkers.end()) {
    const E2eChecker unused(known.own->protection(), known.own->length);
    checker = known.checkers.emplace(interface, unused).first;
  }
  Total& total = totals_[known.message->name];
  const uint64_t lost_before = checker->second.counters().lost;
  const E2eResult result = checker->second.check(frame);
  if (!is_usable(result)) ++total.unusable;
  total.lost += checker->second.counters().lost - lost_before;
  return result;
}

const DecodedFrame* BusListener::decode(const Frame& frame, std::string_view interface) {
  const auto known = known_.find(frame.id);
  if (known == known_.end() || !known->second.message->left_out.empty()) {
    ++unknown_;
    return nullptr;
  }
  const DbcMessage& message = *known->second.message;
  decoded_ = {.message = &message, .is_short = frame.length < message.length};
  ++totals_[message.name].frames;
  if (known->second.own != nullptr) decoded_.e2e = check(frame, interface, known->second);
  add_signals(known->second, frame.payload());
  return &decoded_;
}

std::string_view name_of(E2eResult result) {
  switch (result) {
    case E2eResult::kOk:
      return "ok";
    case E2eResult::kSomeLost:
      return "some_lost";
    case E2eResult::kRepeated:
      return "repeated";
    case E2eResult::kWrongCrc:
      return "wrong_crc";
    case E2eResult::kWrongLength:
      return "wrong_length";
  }
  return "";
}

std::string text_of(const DecodedFrame& frame, double time_s) {
  std::string text = fmt::format("{:.6f} {}", time_s, frame.message->name);
  if (frame.e2e) text += fmt::format(" {}", name_of(*frame.e2e));
  if (frame.is_short) text += " short";
  for (const DecodedSignal& signal : frame.signals) {
    text += fmt::format(" {}=", signal.signal->name);
    if (!signal.value_name.empty()) {
      text += signal.value_name;
    } else {
      text += number_text(signal) + signal.signal->unit;
    }
    if (!signal.is_available && !means_not_available(signal.value_name)) text += "(not_available)";
  }
  return text;
}

std::string json_of(const DecodedFrame& frame, double time_s) {
  nlohmann::ordered_json json;
  json["time_s"] = time_s;
  json["id"] = frame.message->id;
  json["message"] = frame.message->name;
  if (frame.e2e) json["e2e"] = name_of(*frame.e2e);
  if (frame.is_short) json["short"] = true;
  auto& signals = json["signals"] = nlohmann::ordered_json::object();
  for (const DecodedSignal& signal : frame.signals) {
    signals[signal.signal->name] = json_value(signal);
  }
  return dump_json(json);
}

}  // namespace bevloc::can
