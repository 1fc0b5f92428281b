#include "evaluation/localize/prior_text.h"

#include <cmath>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include "can/messages/geo_reference.h"

namespace bevloc::evaluation {
namespace {

constexpr double kAround_m = 1000.0;
// A larger number is a mistake.
constexpr double kFarthest = 1e7;
constexpr double kFullTurn_deg = 360.0;

struct Numbers {
  double first = 0.0;
  double second = 0.0;
  double third = 0.0;
};

std::optional<Numbers> numbers_of(const std::string& text) {
  std::istringstream words(text);
  Numbers numbers;
  char comma_1 = 0;
  char comma_2 = 0;
  words >> numbers.first >> comma_1 >> numbers.second >> comma_2 >> numbers.third;
  const bool complete = !words.fail() && (words >> std::ws).eof();
  if (!complete || comma_1 != ',' || comma_2 != ',') return std::nullopt;
  return numbers;
}

Se2 in_map_frame(const Numbers& numbers) {
  return {numbers.first, numbers.second, wrap_angle(radians(numbers.third))};
}

/// Nothing if the numbers are no place on earth, or if that of the map is unknown.
std::optional<Se2> from_geodetic(const Numbers& numbers, const GeoOrigin& origin) {
  if (!is_known(origin) || std::abs(numbers.first) > 90.0 || std::abs(numbers.second) > 180.0)
    return std::nullopt;
  can::GeoReference reference({origin.latitude_deg, origin.longitude_deg});
  return reference.map_from_geodetic({{numbers.first, numbers.second}, numbers.third});
}

Eigen::AlignedBox2d area_of(const HdMap& map) {
  Eigen::AlignedBox2d area;
  for (const MapElement& element : map.elements) {
    for (const Eigen::Vector2d& point : element.points) area.extend(point);
  }
  return area;
}

std::string place_of(const Se2& pose) {
  return fmt::format("x {:.0f} m, y {:.0f} m", pose.x_m, pose.y_m);
}

}  // namespace

Result<Se2> pose_from(const std::string& text, PoseFrame frame, const HdMap& map) {
  const auto numbers = numbers_of(text);
  if (!numbers) {
    return fail("pose: found '{}', wanted three numbers: X,Y,YAW or LATITUDE,LONGITUDE,HEADING",
                text);
  }
  const bool sensible = std::abs(numbers->first) <= kFarthest &&
                        std::abs(numbers->second) <= kFarthest &&
                        std::abs(numbers->third) <= kFullTurn_deg;
  if (!sensible) {
    return fail("pose: found '{}', wanted at most {:.0f} m and {:.0f} degrees", text, kFarthest,
                kFullTurn_deg);
  }
  const Eigen::AlignedBox2d area = area_of(map);
  const auto is_near = [&area](const Se2& pose) {
    return area.exteriorDistance(pose.translation()) <= kAround_m;
  };
  const Se2 metric = in_map_frame(*numbers);
  const std::optional<Se2> geodetic = from_geodetic(*numbers, map.origin);
  const bool metric_fits = frame != PoseFrame::kGeodetic && is_near(metric);
  const bool geodetic_fits = frame != PoseFrame::kMap && geodetic && is_near(*geodetic);
  if (metric_fits && geodetic_fits) {
    return fail(
        "pose: '{}' lies on the map as metres and as latitude and longitude; "
        "choose with --frame map or --frame geodetic",
        text);
  }
  if (metric_fits) return metric;
  if (geodetic_fits) return *geodetic;
  return fail(
      "pose: found {}, wanted a place at most 1 km outside of the map, which reaches from "
      "x {:.0f} m, y {:.0f} m to x {:.0f} m, y {:.0f} m around {:.5f}, {:.5f}",
      frame == PoseFrame::kGeodetic && geodetic ? place_of(*geodetic) : place_of(metric),
      area.min().x(), area.min().y(), area.max().x(), area.max().y(), map.origin.latitude_deg,
      map.origin.longitude_deg);
}

}  // namespace bevloc::evaluation
