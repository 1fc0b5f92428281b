// Lets only authentic frames of the vehicle through.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "can/messages/message_table.h"
#include "can/messages/secoc_messages.h"
#include "can/secoc/authenticator.h"

namespace bevloc::can {

struct SecocCounters {
  uint64_t authentic = 0;     ///< epochs that were let through
  uint64_t wrong_mac = 0;     ///< epochs that are forged, damaged or replayed
  uint64_t incomplete = 0;    ///< authentications without all frames of their epoch
  uint64_t no_freshness = 0;  ///< epochs before the first VEH_Freshness
};

/// Holds the frames of an epoch back until their authentication has come. The freshness value must
/// be higher than that of every authentic epoch before; so a replay is refused as soon as one later
/// epoch was received. One thread.
class SecocReceiver {
 public:
  SecocReceiver(Cmac cmac, const BaseIds& base) : authenticator_(std::move(cmac)), base_(base) {}

  /// Returns the frames that may be used now: none, those of an authentic epoch, or the frame
  /// itself if it needs no authentication. They are valid until the next call.
  std::span<const ReceivedFrame> accept(const ReceivedFrame& received);

  const SecocCounters& counters() const { return counters_; }

 private:
  static constexpr size_t kMaxMembers = 3;
  /// Messages that one message authenticates.
  struct Group {
    const Message* authentication;
    std::span<const Message* const> members;
    std::array<ReceivedFrame, kMaxMembers> frames{};
    unsigned present = 0;  ///< bit i: frames[i] is of the epoch `epoch`
    int64_t epoch = 0;
  };
  static constexpr const Message* kOdometry[] = {&veh_wheel_speed::kMessage,
                                                 &veh_yaw_rate::kMessage};
  static constexpr const Message* kGnss[] = {
      &veh_gnss_latitude::kMessage, &veh_gnss_longitude::kMessage, &veh_gnss_heading::kMessage};

  static void hold(Group& group, size_t member, const ReceivedFrame& received);
  std::span<const ReceivedFrame> release(Group& group, const Frame& authentication);
  bool is_authentic(const Group& group, const Frame& authentication);
  void take_freshness(const Frame& frame);

  Authenticator authenticator_;
  BaseIds base_;
  std::array<Group, 2> groups_ = {Group{&veh_odometry_authentication::kMessage, kOdometry},
                                  Group{&veh_gnss_authentication::kMessage, kGnss}};
  ReceivedFrame passed_;
  uint64_t announced_high_ = 0;  ///< of the latest VEH_Freshness; anybody can have sent it
  bool announced_ = false;
  uint64_t latest_ = 0;  ///< freshness of the latest authentic epoch
  SecocCounters counters_;
};

}  // namespace bevloc::can
