// The topics of a recording: what writer and readers of recordings must agree on.
#pragma once

#include <string>
#include <string_view>

#include "common/cameras.h"

namespace bevloc::firmware {

/// Names of topics, and in the comment the schema of their messages.
inline constexpr std::string_view kBusInTopic = "/can/in";       ///< bevloc.recording.CanFrame
inline constexpr std::string_view kBusOutTopic = "/can/out";     ///< bevloc.recording.CanFrame
inline constexpr std::string_view kSolutionTopic = "/solution";  ///< bevloc.recording.Solution
inline constexpr std::string_view kPoseTopic = "/pose";          ///< foxglove.PoseInFrame
inline constexpr std::string_view kTruthTopic = "/truth";        ///< foxglove.PoseInFrame
inline constexpr std::string_view kMatchTopic = "/match";        ///< bevloc.recording.Match
inline constexpr std::string_view kMapTopic = "/map";            ///< bevloc.recording.Map
inline constexpr std::string_view kCountersTopic = "/counters";  ///< bevloc.recording.Counters

/// foxglove.RawImage or foxglove.CompressedImage.
inline std::string image_topic(int camera) {
  return "/camera/" + std::string(kCameraNames[camera]);
}
/// foxglove.CameraCalibration.
inline std::string calibration_topic(int camera) {
  return image_topic(camera) + "/calibration";
}

/// The folder of the black box, in that of a recording.
inline constexpr const char* kBlackBoxFolder = "kept";

/// The metadata record of a recording, and its keys.
inline constexpr std::string_view kMetadataName = "bevloc";
inline constexpr std::string_view kClockOffsetKey = "log_time_minus_clock_ns";
inline constexpr std::string_view kStartKey = "start_clock_ns";
inline constexpr std::string_view kLockstepKey = "lockstep";
inline constexpr std::string_view kConfigKey = "configuration_file";
inline constexpr std::string_view kMapFileKey = "map_file";
inline constexpr std::string_view kModelFileKey = "model_file";
inline constexpr std::string_view kMapChecksumKey = "map_crc32";
inline constexpr std::string_view kModelChecksumKey = "model_sha256";

/// The attachments.
inline constexpr std::string_view kConfigAttachment = "configuration.yaml";
inline constexpr std::string_view kRigAttachment = "rig.yaml";
inline constexpr std::string_view kDbcAttachment = "vehicle.dbc";
inline constexpr std::string_view kLearnedAttachment = "learned_calibration.yaml";

}  // namespace bevloc::firmware
