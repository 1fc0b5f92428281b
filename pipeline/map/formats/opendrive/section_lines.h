// The borders of the lanes of an OpenDRIVE lane section, and the outlines of objects, as points.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/map/formats/map_builder.h"
#include "pipeline/map/formats/opendrive/road.h"

namespace bevloc::opendrive {

/// A lane section cut into pieces: `along_m[i]` to `along_m[i + 1]` (s). Border i lies to the left
/// of lane i of the section; border 0 is the right edge of the rightmost lane. The centre takes no
/// space: both borders beside it are the same.
struct SectionLines {
  std::vector<double> along_m;
  std::vector<Line3> borders;  ///< one more than lanes; each with one point per value of along_m

  /// The lateral position (t) of each border, with one value per value of along_m.
  std::vector<std::vector<double>> lateral_m;

  /// Unit vectors to the left of the road, one per value of along_m.
  std::vector<Eigen::Vector2d> lefts;
};

/// A lane that is narrower than this does not exist.
inline constexpr double kNoWidth_m = 0.05;

/// A part of a lane section, cut into pieces. Refers to its document.
struct CutSection {
  const Road* road = nullptr;
  size_t road_index = 0;  ///< in the document
  const LaneSection* section = nullptr;
  SectionLines lines;

  /// The width of a lane at the wider end of a piece, or a negative one if its borders cross.
  double width_m(size_t lane, size_t piece) const;

  /// The two ends of a piece of the paint of a mark, which belongs to a border.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> paint(const RoadMark& mark, size_t border,
                                                    size_t piece) const;

  /// The type of the first lane with a width, from `lane` on in one direction (`step` 1 or -1), or
  /// "none" if there is no such lane.
  std::string type_from(std::ptrdiff_t lane, int step, size_t piece) const;
};

/// The part of a section on a stretch. Its end is before its start if section and stretch do not
/// meet.
Stretch part_of(const LaneSection& section, const Stretch& stretch);

/// Cuts a part of a section at all places where a formula changes, and about every 0.5 m. What
/// begins at the end of the part, such as a lane offset of the next section, does not count.
SectionLines lines_of(const Road& road, const LaneSection& section, const Stretch& part);

/// The outlines of an object, or one from its length and width, or an empty one.
std::vector<Outline> outlines_of(const RoadObject& object);

/// The points of an outline of an object, with the first one again at the end of a closed one.
Line3 points_of(const Road& road, const RoadObject& object, const Outline& outline);

/// The point of a road at (s, t), with its height, which is NaN without an elevation profile.
Eigen::Vector3d point_at(const Road& road, double s_m, double t_m);

/// Whether vehicles can roll over lanes of this type, and whether they drive there.
bool is_paved(std::string_view lane_type);
bool is_driven(std::string_view lane_type);

/// The road mark at the outer border of a lane, `along_m` after the section's start, or null.
const RoadMark* mark_at(const LaneSpec& lane, double along_m);

}  // namespace bevloc::opendrive
