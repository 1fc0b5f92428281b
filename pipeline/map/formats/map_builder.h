// Collects the lines that an importer finds, and makes a map and a report of them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "common/result.h"
#include "pipeline/map/formats/class_table.h"
#include "pipeline/map/formats/import_report.h"
#include "pipeline/map/formats/projection.h"
#include "pipeline/map/hd_map.h"

namespace bevloc {

struct ImportOptions {
  /// Overrides what lines become. If null, the defaults of each format hold.
  const ClassTable* classes = nullptr;
  /// Where the origin of the file's coordinates lies on earth. Takes precedence over what the file
  /// says.
  std::optional<GeoOrigin> origin{};
};

/// Heights of the points of one element in metres, or none where the file lacks one of them.
using Heights = std::vector<double>;

struct ImportedMap {
  HdMap map;
  ImportReport report;
  /// The heights of each element of the map, or empty if the format has none. The localizer does
  /// not use heights; the export does.
  std::vector<Heights> heights_m{};
};

/// A line in the coordinates of the file, in metres; z is NaN where the file has no height.
using Line3 = std::vector<Eigen::Vector3d>;

double length_of(const Line3& line);

/// The line with its first point again at its end, for rings that come without it.
Line3 closed(Line3 ring);

/// Gives an element the shape of its class (hd_map.h): removes consecutive equal points, and from a
/// crossing the repeated corner and the points on its sides. `heights_m` may be empty. Returns why
/// it cannot be of its class, or "".
std::string_view shape_element(MapElement& element, Heights& heights_m);

/// Whether a centre line has a length that a lane can have.
bool can_be_driven(const std::vector<Eigen::Vector2d>& centerline);

/// Whether both bounds have points, and lengths that a lane can have.
bool can_be_lane(const std::vector<Eigen::Vector2d>& left,
                 const std::vector<Eigen::Vector2d>& right);

/// Removes points that lie within `tolerance_m` of the line through their neighbours (in x and y).
Line3 simplified(const Line3& line, double tolerance_m);

/// One thread.
class MapBuilder {
 public:
  MapBuilder(std::string file, const ImportOptions& options);

  /// What a line of this kind becomes, which is `normally` unless the class table has a rule for
  /// it.
  std::optional<Meaning> meaning_of(std::string_view kind,
                                    const std::optional<Meaning>& normally) const;

  /// Adds a line, or the ring of a crossing, if it becomes an element of the map. finish() reports
  /// these lines. Any other line is reported at once. `where` names it ("way 12"); `why_not` says
  /// why it is dropped if `normally` is nothing.
  void add(std::string_view kind, std::string_view where, const std::optional<Meaning>& normally,
           std::string_view why_not, Line3 line);

  /// Reports a line that the map does not take for a reason that no class table changes.
  void drop(std::string_view kind, std::string_view where, std::string_view why, double length_m);

  /// Reports what has no line of its own, such as a point.
  void drop_without_line(std::string_view kind, std::string_view where, std::string_view why) {
    report_.note_without_line(kind, why, where);
  }

  /// Names a part that was lost because the file is wrong there. See HdMap::left_out.
  void leave_out(std::string sentence) { map_.left_out.push_back(std::move(sentence)); }

  /// Whether no element was added.
  bool is_empty() const { return map_.elements.empty(); }

  /// The median of all points that were added, in the coordinates of the file, or (0, 0) without
  /// any.
  Eigen::Vector2d middle() const;

  /// Returns the index of the lane. The bounds are in the coordinates of the file.
  uint32_t add_lane(Lane lane);
  std::vector<Lane>& lanes() { return map_.lanes; }

  /// Says that the coordinates are already those of the tangent plane at this place.
  void keep_plane_at(const GeoOrigin& origin) { plane_at_ = origin; }

  void remark(std::string text) { report_.remark(std::move(text)); }
  const std::string& file() const { return file_; }

  /// Returns the map in the tangent plane at the middle of its points, if `projection` or the
  /// options say where that is. Otherwise it returns the map in the coordinates of the file, which
  /// are shifted only if they are far from zero. Drops elements and lanes that are too far away or
  /// too long. Fails if nothing was taken, if a rule of the class table fits no line of the file,
  /// or if the middle is too far from zero for the origin of the options. Call it once.
  Result<ImportedMap> finish(std::string name, std::unique_ptr<Projection> projection);

 private:
  void place(const Projection* projection);
  void drop_impossible();

  /// What an element was in the file.
  struct Source {
    std::string kind;
    std::string where;
    Meaning meaning;
    bool is_by_rule = false;
    double length_m = 0.0;
  };

  std::string file_;
  ImportOptions options_;
  std::optional<GeoOrigin> plane_at_;
  HdMap map_;
  std::vector<Heights> heights_m_;  ///< one for each element
  std::vector<Source> sources_;     ///< one for each element
  ImportReport report_;
};

}  // namespace bevloc
