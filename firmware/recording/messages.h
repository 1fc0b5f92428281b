// Fills the messages of a recording from the appliance's own types, and back.
#pragma once

#include <vector>

#include <bevloc.pb.h>
#include <foxglove.pb.h>

#include "can/bus/frame.h"
#include "common/result.h"
#include "firmware/recording/recorded_events.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::firmware {

/// Returns the image without loss, in its own format.
foxglove::RawImage raw_image(const RecordedImage& image, uint64_t exposure_start_ns);
/// `jpeg` is the image in this format.
foxglove::CompressedImage compressed_image(const RecordedImage& image, std::string_view jpeg,
                                           uint64_t exposure_start_ns);
/// Returns the pose of the vehicle on the ground, in the frame "map".
foxglove::PoseInFrame pose_message(const Se2& map_from_vehicle, uint64_t time_ns);
Se2 pose_of(const foxglove::PoseInFrame& message);
foxglove::CameraCalibration calibration_message(const CameraModel& camera, int index);

recording::CanFrame bus_message(const RecordedBusFrame& frame);
/// Fails for a message that is no frame, because it is too long or has a wrong identifier.
Result<can::ReceivedFrame> bus_frame_of(const recording::CanFrame& message);
/// `held_ns` is the log time of the moment at which the position held.
foxglove::LocationFix fix_message(const RecordedFix& fix, uint64_t held_ns);
/// Returns the fix that the appliance got at `time`. Fails for values that no receiver reports.
Result<RecordedFix> fix_of(const foxglove::LocationFix& message, Time time);
recording::Solution solution_message(const can::PoseReport& report);
recording::Match match_message(const RecordedMatch& match);

/// A map with more than this many points is left out.
inline constexpr size_t kMostMapPoints = 300'000;
recording::Map map_message(const HdMap& map);
/// Returns the map without its lanes, or nothing if it was left out.
std::optional<HdMap> map_of(const recording::Map& message);

Se2 se2_of(const recording::Pose2& pose);

}  // namespace bevloc::firmware
