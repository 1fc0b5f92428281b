// The pose that a user gives on the command line.
#pragma once

#include <string>

#include "common/result.h"
#include "common/se2.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

/// Which frame the three numbers of a pose are in.
enum class PoseFrame {
  kGuess,     ///< kGeodetic if that place is on the map, otherwise kMap
  kMap,       ///< x and y in metres in the map frame, yaw in degrees counter-clockwise from east
  kGeodetic,  ///< latitude and longitude in degrees (WGS84), heading in degrees from north
};

/// A pose in the map frame, and how its numbers were read.
struct GivenPose {
  Se2 pose;
  PoseFrame frame = PoseFrame::kMap;  ///< kMap or kGeodetic
};

/// Reads "X,Y,YAW" or "LAT,LON,HEADING". Fails if the text is not three numbers, or if the pose
/// lies more than 1 km outside of the map. kGuess also fails if the pose lies on the map as metres
/// only, but within 100 km of it as latitude and longitude, because then it is probably a wrong
/// latitude or longitude.
Result<GivenPose> pose_from(const std::string& text, PoseFrame frame, const HdMap& map);

/// One line: the pose, and how it was read.
std::string text_of(const GivenPose& given);

}  // namespace bevloc::evaluation
