// Lets only authentic frames of the vehicle through.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "can/messages/message_table.h"
#include "can/messages/secoc_messages.h"
#include "can/secoc/authenticator.h"
#include "common/time.h"

namespace bevloc::can {

struct SecocCounters {
  uint64_t authentic = 0;          ///< epochs that passed
  uint64_t wrong_mac = 0;          ///< epochs that were forged, damaged or replayed
  uint64_t incomplete = 0;         ///< epochs without all frames, or without authentication
  uint64_t no_freshness = 0;       ///< epochs before the freshness value of the sender is known
  uint64_t wrong_length = 0;       ///< frames with a wrong length, of epochs or announcements
  uint64_t bad_announcements = 0;  ///< announcements with a wrong CRC
};

/// Holds the frames of an epoch back until their authentication has come. The freshness value must
/// be higher than that of every earlier authentic epoch of the same messages. So a replay is
/// refused as soon as one later epoch was received. Odometry may overtake GNSS on the bus, because
/// its identifiers are lower. So the freshness value may be a little lower than the highest one of
/// all messages.
///
/// Announcements (VEH_Freshness) have no authentication. So the receiver keeps the latest few
/// different ones, among them the sender's own. At first it only listens for a while: it learns the
/// highest authentic freshness value, and lets no frame through. It listens again when there are
/// more announcements than it can keep, because then the sender's own may be lost. One thread.
class SecocReceiver {
 public:
  /// The time for which the receiver only listens, which is a few cycles of VEH_Freshness.
  static constexpr Duration kListening = std::chrono::milliseconds(500);

  SecocReceiver(Cmac cmac, const BaseIds& base, Duration listening = kListening)
      : authenticator_(std::move(cmac)), base_(base), listening_(listening) {}

  /// Returns the frames that may be used now: none, those of an authentic epoch, or the frame
  /// itself if it needs no authentication. They are valid until the next call.
  std::span<const ReceivedFrame> accept(const ReceivedFrame& received);

  const SecocCounters& counters() const { return counters_; }

 private:
  static constexpr size_t kMaxMembers = 3;
  /// How many later epochs of other messages may overtake an epoch: those of 160 ms.
  static constexpr uint64_t kMostOvertaking = 8;
  /// Messages that one message authenticates.
  struct Group {
    const Message* authentication;
    std::span<const Message* const> members;
    std::array<ReceivedFrame, kMaxMembers> frames{};
    unsigned present = 0;  ///< bit i is set if frames[i] belongs to `epoch`
    int64_t epoch = 0;
    uint64_t latest = 0;  ///< freshness of the latest authentic epoch of this group
  };
  static constexpr const Message* kOdometry[] = {&veh_wheel_speed::kMessage,
                                                 &veh_yaw_rate::kMessage};
  static constexpr const Message* kGnss[] = {
      &veh_gnss_latitude::kMessage, &veh_gnss_longitude::kMessage, &veh_gnss_heading::kMessage};

  /// The upper bits of a freshness value, as some node announced them.
  struct Announcement {
    uint64_t high = 0;
    Time received = Time::min();  ///< when it came last; min() if the place is free
  };
  static constexpr size_t kMostAnnouncements = 4;

  void hold(Group& group, size_t member, const ReceivedFrame& received);
  std::span<const ReceivedFrame> release(Group& group, const ReceivedFrame& authentication);
  bool is_authentic(Group& group, const Frame& authentication);
  bool has_freshness(Group& group, const Frame& authentication, uint64_t high);
  void take_freshness(const ReceivedFrame& received);

  Authenticator authenticator_;
  BaseIds base_;
  std::array<Group, 2> groups_ = {Group{&veh_odometry_authentication::kMessage, kOdometry},
                                  Group{&veh_gnss_authentication::kMessage, kGnss}};
  ReceivedFrame passed_;
  Duration listening_;
  std::array<Announcement, kMostAnnouncements> announcements_{};
  Time listens_until_ = Time::max();  ///< max() until the first announcement comes
  uint64_t latest_ = 0;               ///< the highest freshness of an authentic epoch
  SecocCounters counters_;
};

}  // namespace bevloc::can
