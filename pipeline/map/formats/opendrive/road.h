// The parts of an OpenDRIVE road (ASAM OpenDRIVE 1.4 to 1.7) that a map needs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace bevloc::opendrive {

/// The polynomial a + b x + c x^2 + d x^3 with x = s - start.
struct Cubic {
  double start_m = 0.0;
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  double d = 0.0;

  double at(double s_m) const {
    const double x = s_m - start_m;
    return a + x * (b + x * (c + x * d));
  }
};

/// Cubics in the order of their starts; each is valid up to the next.
using Cubics = std::vector<Cubic>;

/// The value at s, or 0 if no cubic begins at or before s. Where a cubic begins, it is the value of
/// this cubic, unless `from_before`.
double value_at(const Cubics& cubics, double s_m, bool from_before = false);

/// One piece of the reference line. Lengths are in m, angles in rad, and curvatures in 1/m.
struct Geometry {
  enum class Kind : uint8_t { kLine, kArc, kSpiral, kPoly3, kParamPoly3 };

  Kind kind = Kind::kLine;
  double start_m = 0.0;
  double length_m = 0.0;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;
  double start_curvature = 0.0;  ///< for an arc, the curvature everywhere
  double end_curvature = 0.0;
  Cubic u;  ///< for a parametric cubic, like v
  Cubic v;
  bool is_normalized = false;  ///< the parameter of the cubics runs from 0 to 1

  /// A point of a spiral or poly3, in the frame of the start of the piece.
  struct Knot {
    double along_m = 0.0;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
  };
  std::vector<Knot> knots{};  ///< places from which an integral may begin; may be empty
};

/// A place on the reference line.
struct LinePose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading_rad = 0.0;
};

/// A part of a road whose reference line has no gap.
struct Stretch {
  double start_m = 0.0;
  double end_m = 0.0;
  double jump_m = 0.0;  ///< distance from its end to the start of the next; 0 if no gap ends it
};

/// Places a knot about every 100 m, so that the time for all points of a long spiral or poly3 does
/// not grow with the square of its length.
void place_knots(Geometry& geometry);

/// The pose at `along_m` (0 to the length) of a piece.
LinePose pose_along(const Geometry& geometry, double along_m);

struct RoadMark {
  double start_m = 0.0;  ///< counted from the start of the lane section
  std::string type;
  double offset_m = 0.0;  ///< mean offset of its lines from the border, positive to the left
  Cubics sways{};         ///< further offsets to the left, counted from the start of the mark

  /// How far the paint lies to the left of the border, `along_m` after the section's start. Where a
  /// sway begins, it is the value of this sway, unless `from_before`.
  double left_of_border_m(double along_m, bool from_before) const;
};

struct LaneSpec {
  int id = 0;
  int line = 0;  ///< in the file
  std::string type;
  Cubics widths;   ///< counted from the start of the lane section
  Cubics borders;  ///< the same for borders, which are used where there are no widths
  std::vector<RoadMark> marks;
  std::optional<double> speed_mps;
};

struct LaneSection {
  double start_m = 0.0;
  double end_m = 0.0;
  int line = 0;                 ///< in the file
  bool is_single_side = false;  ///< the other side continues that of the section before
  /// From the rightmost (smallest id) to the leftmost. Contains the centre, whose id is 0.
  std::vector<LaneSpec> lanes;
};

/// A corner of an object, in the frame of the object (local) or of the road (s, t).
struct Corner {
  bool is_local = true;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

struct Outline {
  std::vector<Corner> corners;
  bool is_closed = true;  ///< whether it surrounds an area; otherwise it is a line
};

/// Copies of an object along the road. The arrays contain the values at the first and at the last
/// copy.
struct Repeat {
  double start_m = 0.0;
  double length_m = 0.0;
  double distance_m = 0.0;
  std::array<double, 2> t_m{};
  std::array<double, 2> z_m{};
  std::array<double, 2> object_length_m{};
  std::array<double, 2> object_width_m{};
};

struct RoadObject {
  std::string id;
  std::string name;
  std::string type;
  int line = 0;
  double s_m = 0.0;
  double t_m = 0.0;
  double z_m = 0.0;
  double heading_rad = 0.0;  ///< relative to the road
  double length_m = 0.0;
  double width_m = 0.0;
  std::vector<Outline> outlines;
  std::vector<Repeat> repeats;  ///< repetitions, read for crosswalks only
  std::string fault{};          ///< why one of its numbers cannot be read, or ""
};

/// Whether the type of an object says that it is a crosswalk. If it has no type, its name counts.
bool is_crosswalk(const RoadObject& object);

/// The object, or its copies if it is repeated. Returns nothing if the repetition has no distance,
/// has too many copies, or has corners in the frame of the road.
std::vector<RoadObject> copies_of(const RoadObject& object);

struct Road {
  std::string id;
  int line = 0;
  double length_m = 0.0;
  bool is_in_junction = false;
  bool drives_left = false;
  std::optional<double> speed_mps;
  std::vector<Geometry> geometries;
  std::vector<Stretch> stretches;
  Cubics elevations;
  Cubics lane_offsets;
  std::vector<LaneSection> sections;
  std::vector<RoadObject> objects;

  /// The pose at s. Where two pieces meet, it is the pose of the later one, unless `from_before`.
  LinePose pose_at(double s_m, bool from_before = false) const;
  bool has_line_at(double s_m) const;
};

/// The parts of the reference line between its gaps, up to the length of the road.
std::vector<Stretch> stretches_of(const Road& road);

/// Adds the other side to single-sided sections. `sections` must be in the order of their starts.
void complete_sides(std::vector<LaneSection>& sections);

/// Moves the start of each lane offset that lies within 5 mm of the start or end of a lane section
/// to it. The sections must have their ends.
void snap_lane_offsets(Road& road);

/// The parts of a road that are lost because the file is wrong there, as sentences with file, line,
/// road and s.
std::vector<std::string> faults_of(const Road& road, std::string_view file);

struct Document {
  std::string file;
  std::string georeference;  ///< the PROJ string, or "" if there is none
  int georeference_line = 0;
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  double offset_heading_rad = 0.0;
  std::vector<Road> roads;
};

}  // namespace bevloc::opendrive
