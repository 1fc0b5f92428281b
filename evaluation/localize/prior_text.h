// The pose that a user gives on the command line.
#pragma once

#include <string>

#include "common/result.h"
#include "common/se2.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

/// Which frame the three numbers of a pose are in.
enum class PoseFrame {
  kGuess,     ///< the one in which the pose lies on the map
  kMap,       ///< x and y in metres in the map frame, yaw in degrees counter-clockwise from east
  kGeodetic,  ///< latitude and longitude in degrees (WGS84), heading in degrees from north
};

/// Reads "X,Y,YAW" or "LAT,LON,HEADING". Fails if the text is not three numbers, if the pose lies
/// more than 1 km outside of the map, or if kGuess finds that it lies on the map in both frames.
Result<Se2> pose_from(const std::string& text, PoseFrame frame, const HdMap& map);

}  // namespace bevloc::evaluation
