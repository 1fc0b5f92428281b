#include "can/secoc/secoc_receiver.h"

#include <algorithm>

namespace bevloc::can {

std::span<const ReceivedFrame> SecocReceiver::accept(const ReceivedFrame& received) {
  const Frame& frame = received.frame;
  const auto is = [&](const Message* message) {
    return message->id(base_) == frame.id && message->length == frame.length;
  };
  if (is(&veh_freshness::kMessage)) {
    take_freshness(frame);
    return {};
  }
  for (Group& group : groups_) {
    if (is(group.authentication)) return release(group, frame);
    for (size_t i = 0; i < group.members.size(); ++i) {
      if (group.members[i]->id(base_) != frame.id) continue;
      if (is(group.members[i])) hold(group, i, received);
      return {};
    }
  }
  passed_ = received;
  return {&passed_, 1};
}

void SecocReceiver::hold(Group& group, size_t member, const ReceivedFrame& received) {
  const int64_t epoch = extract_raw(received.frame, kEpoch);
  if (epoch != group.epoch) group.present = 0;
  group.epoch = epoch;
  group.frames[member] = received;
  group.present |= 1u << member;
}

std::span<const ReceivedFrame> SecocReceiver::release(Group& group, const Frame& authentication) {
  const bool complete = group.present == (1u << group.members.size()) - 1 &&
                        extract_raw(authentication, kEpoch) == group.epoch;
  group.present = 0;
  if (!complete) {
    ++counters_.incomplete;
    return {};
  }
  if (!announced_) {
    ++counters_.no_freshness;
    return {};
  }
  if (!is_authentic(group, authentication)) {
    ++counters_.wrong_mac;
    return {};
  }
  ++counters_.authentic;
  return std::span(group.frames).first(group.members.size());
}

/// Tries the lower bits with the announced upper bits and, as the announcement may be forged, with
/// those of the latest authentic epoch, each also plus one. Only values above the latest one count.
bool SecocReceiver::is_authentic(const Group& group, const Frame& authentication) {
  std::array<Frame, kMaxMembers> frames;
  std::ranges::transform(group.frames, frames.begin(), &ReceivedFrame::frame);
  const std::span<const Frame> members = std::span(frames).first(group.members.size());
  const auto low = static_cast<uint64_t>(extract_raw(authentication, secoc::kFreshnessLow));
  const uint64_t latest_high = latest_ >> 16U;
  for (const uint64_t high : {announced_high_, announced_high_ + 1, latest_high, latest_high + 1}) {
    const uint64_t freshness = high << 16U | low;
    if (freshness <= latest_) continue;
    const auto mac = authenticator_.mac(*group.authentication, freshness, members);
    if (!mac || *mac != static_cast<uint32_t>(extract_raw(authentication, secoc::kMac))) continue;
    latest_ = freshness;
    return true;
  }
  return false;
}

void SecocReceiver::take_freshness(const Frame& frame) {
  if (!has_valid_crc(frame, veh_freshness::kMessage.protection())) return;
  announced_high_ = static_cast<uint64_t>(extract_raw(frame, secoc::kFreshnessHigh));
  announced_ = true;
}

}  // namespace bevloc::can
