// Binds the counters and checksums of messages, and checks the messages at the end.
#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "can/bus/frame.h"
#include "can/vehicle/vehicle_binder.h"
#include "common/number_text.h"

namespace bevloc::can {
namespace {

constexpr double kSlowestGnss_ms = 2000.0;
constexpr double kFastest_ms = 1.0;

Bound<size_t> checksum_byte_of(const DbcSignal& signal) {
  const SignalLayout& layout = signal.layout;
  const bool whole_byte = layout.length_bits == 8 &&
                          layout.start_bit % 8 == (layout.order == ByteOrder::kIntel ? 0 : 7);
  if (whole_byte) return static_cast<size_t>(layout.start_bit / 8);
  return refusal(fmt::format("checksum {} with {} bits from bit {}", signal.name,
                             layout.length_bits, layout.start_bit),
                 "a whole byte", "checksum");
}

/// Returns the last number of a text such as "P02", "Profile 2" or "E2E_P05".
int profile_number(const std::string& text) {
  const size_t end = text.find_last_of("0123456789");
  if (end == std::string::npos) return 0;
  size_t begin = end;
  while (begin > 0 && text[begin - 1] >= '0' && text[begin - 1] <= '9') --begin;
  int number = 0;
  std::from_chars(text.data() + begin, text.data() + end + 1, number);
  return number;
}

int highest_data_id(ChecksumKind kind) {
  return kind == ChecksumKind::kE2eP05 ? UINT16_MAX : UINT8_MAX;
}

Bound<void> check_data_ids(const ProtectionRequest& request) {
  const size_t ids = request.data_ids.size();
  const std::string key = ids == 1 ? "data_id" : "data_ids";
  const ChecksumKind kind = request.kind.value_or(ChecksumKind::kNone);
  const bool is_p02 = kind == ChecksumKind::kE2eP02;
  const bool is_profile = is_p02 || kind == ChecksumKind::kE2eP05;
  if (is_profile && ids != 1 && ids != (is_p02 ? 16 : 1)) {
    return refusal(fmt::format("{} data ids", ids), "data_id, or 16 data_ids for profile P02");
  }
  if (kind == ChecksumKind::kNone && ids > 0) {
    return refusal("data ids without a checksum", "an algorithm beside them", key);
  }
  if (!is_profile && ids > 1 && request.counter.empty()) {
    return refusal("data_ids without a counter", "a counter beside them, or one data_id", key);
  }
  for (const uint16_t id : request.data_ids) {
    if (id > highest_data_id(kind)) {
      return refusal(fmt::format("data id {}", id), "at most 255; only e2e_p05 has 16 bits", key);
    }
  }
  return {};
}

/// A set of bits of a frame.
class FrameBits {
 public:
  void add(const SignalLayout& layout) { insert_bits(layout, UINT64_MAX, bits_); }
  bool overlaps(const FrameBits& other) const {
    for (size_t i = 0; i < bits_.size(); ++i) {
      if ((bits_[i] & other.bits_[i]) != 0) return true;
    }
    return false;
  }

 private:
  std::array<uint8_t, kMaxFdLength> bits_{};
};

FrameBits checksum_bits(const MessageProtection& protection) {
  FrameBits bits;
  const int first = protection.is_profile() ? 0 : 8 * static_cast<int>(protection.checksum_byte);
  const int length = protection.checksum == ChecksumKind::kE2eP05 ? 16 : 8;
  if (protection.checksum != ChecksumKind::kNone) {
    bits.add({.start_bit = first, .length_bits = length});
  }
  return bits;
}

FrameBits counter_bits(const MessageProtection& protection) {
  FrameBits bits;
  if (protection.checksum == ChecksumKind::kE2eP02) bits.add({.start_bit = 8, .length_bits = 4});
  if (protection.checksum == ChecksumKind::kE2eP05) bits.add({.start_bit = 16, .length_bits = 8});
  if (protection.counter) bits.add(*protection.counter);
  return bits;
}

/// Returns the bits of the value and of its multiplexor.
FrameBits bits_of(const BoundSignal& signal) {
  FrameBits bits;
  bits.add(signal.layout);
  if (signal.multiplexed) bits.add(signal.multiplexed->multiplexor);
  return bits;
}

}  // namespace

const ProtectionRequest* VehicleBinder::request_of(const std::string& message) const {
  const auto found = std::ranges::find(requests_, message, &ProtectionRequest::message);
  return found == requests_.end() ? nullptr : &*found;
}

/// Finds the signal of a counter or checksum. Every frame of the message must contain it.
Bound<const DbcSignal*> VehicleBinder::protecting(const std::string& signal,
                                                  const std::string& message,
                                                  const std::string& key) const {
  const DbcMessage* of = nullptr;
  const auto found = find(signal, message, of);
  if (!found) return refusal(found.error().found, found.error().wanted, key);
  if (of->name != message) {
    return refusal(fmt::format("{} of message {}", (*found)->name, of->name),
                   fmt::format("a signal of message {}", message), key);
  }
  if (!(*found)->multiplexed_at.empty()) {
    return refusal(fmt::format("{}, which is multiplexed", (*found)->name),
                   "a counter or checksum that is in every frame", key);
  }
  return found;
}

Bound<void> VehicleBinder::set_counter(const ProtectionRequest& request,
                                       MessageProtection& protection) const {
  if (request.counter.empty()) {
    if (!request.highest_counter) return {};
    return refusal("highest_counter without a counter", "a counter beside it", "highest_counter");
  }
  const auto counter = protecting(request.counter, request.message, "counter");
  if (!counter) return tl::unexpected(counter.error());
  const int bits = (*counter)->layout.length_bits;
  if (bits > 8) {
    return refusal(fmt::format("a counter with {} bits", bits), "at most 8 bits", "counter");
  }
  protection.counter = (*counter)->layout;
  const uint32_t highest = (1U << bits) - 1;
  protection.highest_counter = static_cast<uint8_t>(request.highest_counter.value_or(highest));
  if (protection.highest_counter > highest) {
    return refusal(fmt::format("highest counter {}", protection.highest_counter),
                   fmt::format("at most {}", highest), "highest_counter");
  }
  return {};
}

Bound<void> VehicleBinder::protect(const ProtectionRequest& request) {
  const auto name = message_name(request.message);
  if (!name) return tl::unexpected(name.error());
  const auto bound = std::ranges::find(binding_.messages, *name, &BoundMessage::name);
  if (bound == binding_.messages.end()) {
    return refusal(*name, "a message that odometry or GNSS uses");
  }
  if (request_of(*name) != nullptr) {
    return refusal(fmt::format("a second entry for {}", *name), "one for each message");
  }
  if (auto good = check_data_ids(request); !good) return good;
  if (request.cycle_ms) bound->cycle = from_milliseconds(*request.cycle_ms);
  MessageProtection& protection = bound->protection;
  protection.checksum = request.kind.value_or(ChecksumKind::kNone);
  protection.data_ids = request.data_ids;
  if (auto good = set_counter(request, protection); !good) return good;
  if (!request.checksum.empty()) {
    const auto checksum = protecting(request.checksum, *name, "checksum");
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
  const ChecksumKind kind = number == 2 ? ChecksumKind::kE2eP02 : ChecksumKind::kE2eP05;
  const auto id = parse_number<int64_t>(data_id->second);
  if (!id || *id < 0 || *id > highest_data_id(kind)) {
    return refusal(fmt::format("E2EDataId {}", data_id->second),
                   fmt::format("0 to {} for profile P0{}", highest_data_id(kind), number));
  }
  message.protection.checksum = kind;
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

/// Refuses a value that shares bits with the counter or the checksum.
Bound<void> VehicleBinder::check_places(const BoundMessage& message) const {
  const FrameBits checksum = checksum_bits(message.protection);
  const FrameBits counter = counter_bits(message.protection);
  if (checksum.overlaps(counter)) return refusal("its counter in its checksum", "separate bits");
  for (const BoundSignal& signal : binding_.signals) {
    const bool is_here = binding_.messages[signal.message].name == message.name;
    if (!is_here) continue;
    const FrameBits bits = bits_of(signal);
    if (bits.overlaps(checksum)) {
      return refusal(fmt::format("{} in the bits of its checksum", signal.name),
                     "separate bits for each");
    }
    if (bits.overlaps(counter)) {
      return refusal(fmt::format("{} in the bits of its counter", signal.name),
                     "separate bits for each");
    }
  }
  return {};
}

/// Refuses two values that share bits, because they would be one value. Signals that different
/// values of a multiplexor select may share bits.
Bound<void> VehicleBinder::check_values(const BoundMessage& message) const {
  std::vector<const BoundSignal*> values;
  for (const auto& [index, quantity] : quantities_) {
    const BoundSignal& signal = binding_.signals[index];
    if (binding_.messages[signal.message].name == message.name) values.push_back(&signal);
  }
  const auto are_together = [](const BoundSignal& a, const BoundSignal& b) {
    return !a.multiplexed || !b.multiplexed || a.multiplexed->value == b.multiplexed->value;
  };
  for (size_t i = 0; i < values.size(); ++i) {
    FrameBits bits;
    bits.add(values[i]->layout);
    for (size_t j = 0; j < i; ++j) {
      FrameBits others;
      others.add(values[j]->layout);
      if (!bits.overlaps(others) || !are_together(*values[i], *values[j])) continue;
      return refusal(fmt::format("{} in the bits of {}", values[i]->name, values[j]->name),
                     "separate bits for each value");
    }
  }
  return {};
}

Bound<void> VehicleBinder::finish_message(BoundMessage& message) {
  if (!is_valid_length(FrameFormat::kFd, message.length)) {
    return refusal(fmt::format("{} bytes", message.length),
                   "a length of CAN frames: 0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes");
  }
  const ProtectionRequest* request = request_of(message.name);
  if (request == nullptr || !request->replaces_attributes()) {
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
  if (auto good = check_places(message); !good) return good;
  if (auto good = check_values(message); !good) return good;
  const double cycle_ms = to_milliseconds(message.cycle);
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
