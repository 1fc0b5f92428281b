#include "can/secoc/secoc_receiver.h"

#include <algorithm>

namespace bevloc::can {

std::span<const ReceivedFrame> SecocReceiver::accept(const ReceivedFrame& received) {
  const Frame& frame = received.frame;
  const auto is = [&](const Message* message) { return message->id(base_) == frame.id; };
  const auto has_length = [&](const Message* message) {
    if (frame.length == message->length) return true;
    ++counters_.wrong_length;
    return false;
  };
  if (is(&veh_freshness::kMessage)) {
    if (has_length(&veh_freshness::kMessage)) take_freshness(received);
    return {};
  }
  for (Group& group : groups_) {
    if (is(group.authentication)) {
      if (!has_length(group.authentication)) return {};
      return release(group, received);
    }
    for (size_t i = 0; i < group.members.size(); ++i) {
      if (!is(group.members[i])) continue;
      if (has_length(group.members[i])) hold(group, i, received);
      return {};
    }
  }
  passed_ = received;
  return {&passed_, 1};
}

void SecocReceiver::hold(Group& group, size_t member, const ReceivedFrame& received) {
  const int64_t epoch = extract_raw(received.frame, kEpoch);
  if (epoch != group.epoch) {
    if (group.present != 0) ++counters_.incomplete;
    group.present = 0;
  }
  group.epoch = epoch;
  group.frames[member] = received;
  group.present |= 1u << member;
}

std::span<const ReceivedFrame> SecocReceiver::release(Group& group,
                                                      const ReceivedFrame& authentication) {
  const bool complete = group.present == (1u << group.members.size()) - 1 &&
                        extract_raw(authentication.frame, kEpoch) == group.epoch;
  group.present = 0;
  if (!complete) {
    ++counters_.incomplete;
    return {};
  }
  const bool listens = authentication.received < listens_until_;
  const bool authentic = is_authentic(group, authentication.frame);
  if (listens) {
    ++counters_.no_freshness;
    return {};
  }
  if (!authentic) {
    ++counters_.wrong_mac;
    return {};
  }
  ++counters_.authentic;
  return std::span(group.frames).first(group.members.size());
}

/// Tries the lower bits with all announced upper bits. Because these may be forged, also tries the
/// upper bits of the latest authentic epochs. Tries each of them plus one, too.
bool SecocReceiver::is_authentic(Group& group, const Frame& authentication) {
  std::array<uint64_t, kMostAnnouncements + 2> highs{latest_ >> 16U, group.latest >> 16U};
  size_t count = 2;
  for (const Announcement& announcement : announcements_) {
    if (announcement.received != Time::min()) highs[count++] = announcement.high;
  }
  return std::ranges::any_of(std::span(highs).first(count), [&](uint64_t high) {
    return has_freshness(group, authentication, high) ||
           has_freshness(group, authentication, high + 1);
  });
}

/// Whether the epoch is authentic with these upper bits. Only a value above the latest one of these
/// messages counts, and becomes the latest one.
bool SecocReceiver::has_freshness(Group& group, const Frame& authentication, uint64_t high) {
  const auto low = static_cast<uint64_t>(extract_raw(authentication, secoc::kFreshnessLow));
  const uint64_t freshness = high << 16U | low;
  if (freshness <= group.latest || freshness + kMostOvertaking < latest_) return false;
  std::array<Frame, kMaxMembers> frames;
  std::ranges::transform(group.frames, frames.begin(), &ReceivedFrame::frame);
  const auto mac = authenticator_.mac(*group.authentication, freshness,
                                      std::span(frames).first(group.members.size()));
  if (!mac || *mac != static_cast<uint32_t>(extract_raw(authentication, secoc::kMac))) return false;
  group.latest = freshness;
  latest_ = std::max(latest_, freshness);
  return true;
}

void SecocReceiver::take_freshness(const ReceivedFrame& received) {
  if (!has_valid_crc(received.frame, veh_freshness::kMessage.protection())) {
    ++counters_.bad_announcements;
    return;
  }
  const auto high = static_cast<uint64_t>(extract_raw(received.frame, secoc::kFreshnessHigh));
  const bool is_first = listens_until_ == Time::max();
  auto place = std::ranges::find(announcements_, high, &Announcement::high);
  if (place == announcements_.end()) {
    place = std::ranges::min_element(announcements_, {}, &Announcement::received);
    const bool is_in_use =
        place->received != Time::min() && received.received - place->received < listening_;
    if (is_in_use) listens_until_ = received.received + listening_;
  }
  *place = {high, received.received};
  if (is_first) listens_until_ = received.received + listening_;
}

}  // namespace bevloc::can
