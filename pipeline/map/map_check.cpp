#include "pipeline/map/map_check.h"

#include <algorithm>
#include <string_view>

#include "pipeline/map/lanelet_geometry.h"

namespace bevloc {
namespace {

Status check_polyline(const std::vector<Eigen::Vector2d>& points, std::string_view what,
                      size_t index, const std::string& file) {
  for (size_t i = 0; i < points.size(); ++i) {
    if (!is_near_origin(points[i])) {
      return fail("{}: {} {}: found a point ({:g}, {:g}) m from the origin, wanted at most {:g} m",
                  file, what, index, points[i].x(), points[i].y(), kFarthestFromOriginM);
    }
  }
  const double length_m = polyline_length(points);
  if (length_m <= kLongestPolylineM) return {};
  return fail("{}: {} {}: found a line of {:g} m, wanted at most {:g} m", file, what, index,
              length_m, kLongestPolylineM);
}

}  // namespace

tl::unexpected<Error> far_from_origin(const std::string& file, const Eigen::Vector2d& middle) {
  return fail(
      "{}: found a map whose middle is at ({:.0f}, {:.0f}) m, wanted it within {:g} km of (0, 0), "
      "because --origin gives the place of (0, 0)",
      file, middle.x(), middle.y(), kFarthestFromOriginM / 1000.0);
}

Status check_map(const HdMap& map, const std::string& file) {
  const bool has_line = std::ranges::any_of(
      map.elements, [](const MapElement& element) { return element.points.size() > 1; });
  if (!has_line) {
    return fail(
        "{}: found {} lanes and no line of a divider, crossing or boundary, wanted lines to match",
        file, map.lanes.size());
  }
  for (size_t i = 0; i < map.elements.size(); ++i) {
    const Status status = check_polyline(map.elements[i].points, "element", i, file);
    if (!status) return status;
  }
  for (size_t i = 0; i < map.lanes.size(); ++i) {
    const Lane& lane = map.lanes[i];
    for (const auto* line : {&lane.left, &lane.right, &lane.centerline}) {
      if (const Status status = check_polyline(*line, "lane", i, file); !status) return status;
    }
  }
  return {};
}

}  // namespace bevloc
