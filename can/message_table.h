// Every message on the bus. Encoding, decoding, the DBC file and the documentation all come from
// here.
#pragma once

#include "can/localizer_messages.h"
#include "can/message.h"
#include "can/solution_fd_message.h"
#include "can/vehicle_messages.h"

namespace bevloc::can {

inline constexpr const Message* kMessages[] = {
    &loc_status::kMessage,        &loc_time::kMessage,           &loc_latitude::kMessage,
    &loc_longitude::kMessage,     &loc_pos_local::kMessage,      &loc_attitude::kMessage,
    &loc_velocity::kMessage,      &loc_std_dev::kMessage,        &loc_correction::kMessage,
    &loc_solution::kMessage,      &veh_wheel_speed::kMessage,    &veh_yaw_rate::kMessage,
    &veh_gnss_latitude::kMessage, &veh_gnss_longitude::kMessage, &veh_gnss_heading::kMessage,
};

}  // namespace bevloc::can
