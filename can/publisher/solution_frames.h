// Encodes a report as the frames of one solution.
#pragma once

#include <array>

#include "can/bus/frame.h"
#include "can/messages/geo_reference.h"
#include "can/messages/message_table.h"
#include "can/messages/pose_report.h"
#include "common/time.h"

namespace bevloc::can {

/// The maximum age of PoseReport::pose_time in a report whose pose is sent as valid. An older
/// report shows that its producer hangs.
inline constexpr Duration kMaxPoseAge = std::chrono::milliseconds(50);
/// The maximum age of PoseReport::capture_time of a pose that is sent as valid, whatever the state
/// of the tracker.
inline constexpr Duration kMaxCaptureAge = std::chrono::seconds(5);

/// Returns the status to send. It is the status of the report, unless that claims a pose which must
/// not be sent. Such a pose is not finite, is out of range or has an invalid covariance
/// (kPoseInvalid), or is too old (kPoseStale). Then the state is LOST, with these reasons.
LocalizerStatus status_to_send(const PoseReport& report, Time now);

Frame status_frame(const LocalizerStatus& status, const BaseIds& base);

/// Returns the frame LOC_Clock. Its error is SNA if there is no source of time.
Frame clock_frame(const ClockReport& clock, const BaseIds& base);

/// `item` is a raw value of loc_identity::kItem.
Frame identity_frame(const Identity& identity, int item, const BaseIds& base);

/// The messages of a solution in the order of sending, without LOC_Status.
inline constexpr std::array<const Message*, 9> kSolutionMessages = {
    &loc_time::kMessage,      &loc_latitude::kMessage,   &loc_longitude::kMessage,
    &loc_pos_local::kMessage, &loc_attitude::kMessage,   &loc_velocity::kMessage,
    &loc_std_dev::kMessage,   &loc_correction::kMessage, &loc_integrity::kMessage};
using SolutionFrames = std::array<Frame, kSolutionMessages.size()>;

/// Returns the frames of `report` for sending at `now`, without epoch and protection. `status`
/// comes from status_to_send(). Values that are not valid under this status or not finite are SNA.
SolutionFrames solution_frames(const PoseReport& report, const LocalizerStatus& status,
                               GeoReference& geo, const BaseIds& base, Time now);

}  // namespace bevloc::can
