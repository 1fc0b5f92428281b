#include "pipeline/map/formats/json_points.h"

#include <cmath>
#include <limits>

#include "common/json_dump.h"

namespace bevloc {
namespace {

/// The coordinates of a map are below this limit, also in UTM.
constexpr double kLargestCoordinate_m = 1e8;

Result<double> coordinate_at(const JsonText& document, const nlohmann::json& point,
                             const char* axis, const JsonPath& path) {
  const nlohmann::json& value = member(point, axis);
  if (value.is_number() && std::abs(value.get<double>()) <= kLargestCoordinate_m) {
    return value.get<double>();
  }
  return fail("{}: found {} = {:.40}, wanted a number of metres", document.place(path), axis,
              dump_json(value));
}

}  // namespace

std::string id_text(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_number_integer() ? dump_json(value) : "";
}

const nlohmann::json& member(const nlohmann::json& object, std::string_view key) {
  static const nlohmann::json kNone;
  if (!object.is_object()) return kNone;
  const auto found = object.find(std::string(key));
  return found == object.end() ? kNone : *found;
}

std::string text_member(const nlohmann::json& object, std::string_view key) {
  const nlohmann::json& value = member(object, key);
  return value.is_string() ? value.get<std::string>() : "";
}

Result<Line3> xyz_points(const JsonText& document, const nlohmann::json& points,
                         const JsonPath& path, size_t least) {
  if (!points.is_array() || points.size() < least) {
    return fail("{}: found {} points, wanted at least {}", document.place(path),
                points.is_array() ? points.size() : 0, least);
  }
  Line3 line;
  for (size_t i = 0; i < points.size(); ++i) {
    const auto x = coordinate_at(document, points[i], "x", path / i);
    const auto y = x ? coordinate_at(document, points[i], "y", path / i) : x;
    if (!y) return tl::unexpected(y.error());
    const bool has_z = member(points[i], "z").is_number();
    const double z =
        has_z ? points[i]["z"].get<double>() : std::numeric_limits<double>::quiet_NaN();
    line.emplace_back(*x, *y, z);
  }
  return line;
}

}  // namespace bevloc
