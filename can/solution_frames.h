// The content of the frames of one solution.
#pragma once

#include <array>

#include "can/frame.h"
#include "can/geo_reference.h"
#include "can/message_table.h"
#include "can/pose_report.h"

namespace bevloc::can {

/// How old a report may be and still be sent.
struct ReportLimits {
  /// A pose predicted to a moment further back than this is stale: whoever makes the reports hangs.
  Duration max_pose_age = std::chrono::milliseconds(50);
  /// A pose whose newest images are older than this is stale, whatever the tracker thinks of it.
  Duration max_capture_age = std::chrono::seconds(5);
};

/// TRACKING and DEGRADED say that there is a pose to use.
bool claims_pose(LocalizerState state);

/// The status that the bus is told. It is the report's own, unless this claims a pose that must not
/// be sent: not finite, out of range, with an unsound covariance (kPoseInvalid), or too old
/// (kPoseStale). Then it is LOST for these reasons.
LocalizerStatus told_status(const PoseReport& report, const ReportLimits& limits, Time now);

Frame status_frame(const LocalizerStatus& status, const BaseIds& base);

/// The messages of a solution, in the order in which they are sent; LOC_Status is apart.
inline constexpr std::array<const Message*, 8> kSolutionMessages = {
    &loc_time::kMessage,      &loc_latitude::kMessage,  &loc_longitude::kMessage,
    &loc_pos_local::kMessage, &loc_attitude::kMessage,  &loc_velocity::kMessage,
    &loc_std_dev::kMessage,   &loc_correction::kMessage};
using SolutionFrames = std::array<Frame, kSolutionMessages.size()>;

/// The frames of `report` as sent at `now` under the status that told_status() gave; neither epoch
/// nor protection is in them yet. What the status makes unusable, and what is not finite, is SNA.
SolutionFrames solution_frames(const PoseReport& report, const LocalizerStatus& told,
                               const ReportLimits& limits, GeoReference& geo, const BaseIds& base,
                               Time now);

}  // namespace bevloc::can
