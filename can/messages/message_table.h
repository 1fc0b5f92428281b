// The table of all messages on the bus, from which encoders, decoders, the DBC file and the
// documentation are made.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "can/messages/clock_message.h"
#include "can/messages/identity_message.h"
#include "can/messages/integrity_message.h"
#include "can/messages/localizer_messages.h"
#include "can/messages/message.h"
#include "can/messages/secoc_messages.h"
#include "can/messages/solution_fd_message.h"
#include "can/messages/vehicle_messages.h"

namespace bevloc::can {

inline constexpr const Message* kMessages[] = {
    &loc_status::kMessage,
    &loc_time::kMessage,
    &loc_latitude::kMessage,
    &loc_longitude::kMessage,
    &loc_pos_local::kMessage,
    &loc_attitude::kMessage,
    &loc_velocity::kMessage,
    &loc_std_dev::kMessage,
    &loc_correction::kMessage,
    &loc_integrity::kMessage,
    &loc_identity::kMessage,
    &loc_solution::kMessage,
    &loc_authentication::kMessage,
    &loc_freshness::kMessage,
    &loc_clock::kMessage,
    &veh_wheel_speed::kMessage,
    &veh_yaw_rate::kMessage,
    &veh_gnss_latitude::kMessage,
    &veh_gnss_longitude::kMessage,
    &veh_gnss_heading::kMessage,
    &veh_odometry_authentication::kMessage,
    &veh_gnss_authentication::kMessage,
    &veh_freshness::kMessage,
};

/// Returns the identifiers of all messages of the localizer, also of those that a configuration
/// does not send.
inline std::vector<uint32_t> localizer_ids(const BaseIds& base) {
  std::vector<uint32_t> ids;
  for (const Message* message : kMessages) {
    if (message->sender == Sender::kLocalizer) ids.push_back(message->id(base));
  }
  return ids;
}

/// Whether a message of the localizer has this identifier.
inline bool is_localizer_id(uint32_t id, const BaseIds& base) {
  return std::ranges::any_of(kMessages, [&](const Message* message) {
    return message->sender == Sender::kLocalizer && message->id(base) == id;
  });
}

}  // namespace bevloc::can
