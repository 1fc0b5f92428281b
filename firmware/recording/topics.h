// The topics of a recording, and the other names that its writer and readers share.
#pragma once

#include <string>
#include <string_view>

#include "common/cameras.h"

namespace bevloc::firmware {

/// The names of the topics. Each comment names the schema of the messages.
inline constexpr std::string_view kBusInTopic = "/can/in";       ///< bevloc.recording.CanFrame
inline constexpr std::string_view kBusOutTopic = "/can/out";     ///< bevloc.recording.CanFrame
inline constexpr std::string_view kGnssTopic = "/gnss";          ///< foxglove.LocationFix
inline constexpr std::string_view kSolutionTopic = "/solution";  ///< bevloc.recording.Solution
inline constexpr std::string_view kPoseTopic = "/pose";          ///< foxglove.PoseInFrame
inline constexpr std::string_view kTruthTopic = "/truth";        ///< foxglove.PoseInFrame
inline constexpr std::string_view kMatchTopic = "/match";        ///< bevloc.recording.Match
inline constexpr std::string_view kMapTopic = "/map";            ///< bevloc.recording.Map
inline constexpr std::string_view kCountersTopic = "/counters";  ///< bevloc.recording.Counters

/// The topic of a camera's images: foxglove.RawImage or foxglove.CompressedImage.
inline std::string image_topic(int camera) {
  return "/camera/" + std::string(kCameraNames[camera]);
}
/// The topic of a camera's calibration: foxglove.CameraCalibration.
inline std::string calibration_topic(int camera) {
  return image_topic(camera) + "/calibration";
}

/// The folder of the black box, in the folder of the recording.
inline constexpr const char* kBlackBoxFolder = "kept";

/// The metadata record of a recording, and its keys.
inline constexpr std::string_view kMetadataName = "bevloc";
inline constexpr std::string_view kVersionKey = "version";
inline constexpr std::string_view kClockOffsetKey = "log_time_minus_clock_ns";
inline constexpr std::string_view kStartKey = "start_clock_ns";
inline constexpr std::string_view kLockstepKey = "lockstep";
inline constexpr std::string_view kConfigKey = "configuration_file";
inline constexpr std::string_view kMapFileKey = "map_file";
inline constexpr std::string_view kModelFileKey = "model_file";
inline constexpr std::string_view kMapChecksumKey = "map_crc32";
inline constexpr std::string_view kModelChecksumKey = "model_sha256";

/// The names of the attachments.
inline constexpr std::string_view kConfigAttachment = "configuration.yaml";
inline constexpr std::string_view kRigAttachment = "rig.yaml";
inline constexpr std::string_view kDbcAttachment = "vehicle.dbc";
inline constexpr std::string_view kLearnedAttachment = "learned_calibration.yaml";

}  // namespace bevloc::firmware
