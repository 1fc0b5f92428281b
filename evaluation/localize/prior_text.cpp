#include "evaluation/localize/prior_text.h"

#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include "can/messages/geo_reference.h"
#include "common/geodetic.h"
#include "pipeline/map/map_points.h"

namespace bevloc::evaluation {
namespace {

constexpr double kAround_m = 1000.0;
/// Numbers that are this near as latitude and longitude are hardly ever metres.
constexpr double kMistaken_m = 100e3;
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
  if (!is_known(origin) || !is_on_earth(numbers.first, numbers.second)) return std::nullopt;
  can::GeoReference reference({origin.latitude_deg, origin.longitude_deg});
  return reference.map_from_geodetic({{numbers.first, numbers.second}, numbers.third});
}

/// The least distance in metres between a pose and the rectangle around the map's points.
double distance_m(const Eigen::AlignedBox2d& area, const Se2& pose) {
  return area.exteriorDistance(pose.translation());
}

std::string in_words(const Se2& pose) {
  return fmt::format("x {:.0f} m, y {:.0f} m", pose.x_m, pose.y_m);
}

/// Says why the numbers cannot be read as latitude and longitude on this map.
Error no_geodetic_place(const Numbers& numbers, const GeoOrigin& origin) {
  if (!is_known(origin)) {
    return {
        "--prior: found a map whose place on earth is unknown, wanted X,Y,YAW in metres and "
        "degrees of its frame, with --frame map"};
  }
  const bool is_latitude = std::abs(numbers.first) > kMostLatitude_deg;
  return {fmt::format("--prior: found {0:g} as {1}, wanted -{2:.0f} to {2:.0f}",
                      is_latitude ? numbers.first : numbers.second,
                      is_latitude ? "latitude" : "longitude",
                      is_latitude ? kMostLatitude_deg : kMostLongitude_deg)};
}

/// `found`: the place in one reading, or in both.
Error outside_of(const Eigen::AlignedBox2d& area, const GeoOrigin& origin,
                 const std::string& found) {
  const std::string around =
      is_known(origin)
          ? fmt::format(" around {:.5f}, {:.5f}", origin.latitude_deg, origin.longitude_deg)
          : "";
  return {
      fmt::format("--prior: found {}, wanted a place at most {:.0f} km outside of the map, which "
                  "reaches from x {:.0f} m, y {:.0f} m to x {:.0f} m, y {:.0f} m{}",
                  found, kAround_m / 1000.0, area.min().x(), area.min().y(), area.max().x(),
                  area.max().y(), around)};
}

}  // namespace

Result<GivenPose> pose_from(const std::string& text, PoseFrame frame, const HdMap& map) {
  const auto numbers = numbers_of(text);
  if (!numbers) {
    return fail("--prior: found '{}', wanted three numbers: X,Y,YAW or LATITUDE,LONGITUDE,HEADING",
                text);
  }
  const bool sensible = std::abs(numbers->first) <= kFarthest &&
                        std::abs(numbers->second) <= kFarthest &&
                        std::abs(numbers->third) <= kFullTurn_deg;
  if (!sensible) {
    return fail("--prior: found '{}', wanted at most {:.0f} m and {:.0f} degrees", text, kFarthest,
                kFullTurn_deg);
  }
  const Eigen::AlignedBox2d area = bounds_of(map);
  const Se2 metric = in_map_frame(*numbers);
  const std::optional<Se2> geodetic = from_geodetic(*numbers, map.origin);
  const bool is_metric = distance_m(area, metric) <= kAround_m;
  if (frame == PoseFrame::kMap) {
    if (is_metric) return GivenPose{metric, PoseFrame::kMap};
    return tl::unexpected(outside_of(area, map.origin, in_words(metric)));
  }
  const double geodetic_m =
      geodetic ? distance_m(area, *geodetic) : std::numeric_limits<double>::infinity();
  if (geodetic_m <= kAround_m) return GivenPose{*geodetic, PoseFrame::kGeodetic};
  if (frame == PoseFrame::kGeodetic) {
    return tl::unexpected(geodetic ? outside_of(area, map.origin, in_words(*geodetic))
                                   : no_geodetic_place(*numbers, map.origin));
  }
  if (is_metric && geodetic_m <= kMistaken_m) {
    return fail(
        "--prior: found '{}', which is {:.1f} km outside of the map as latitude and longitude, "
        "but on it as metres; wanted a place on the map, or --frame map if these are metres",
        text, geodetic_m / 1000.0);
  }
  if (is_metric) return GivenPose{metric, PoseFrame::kMap};
  const std::string as_degrees =
      geodetic ? fmt::format(" (as latitude and longitude: {})", in_words(*geodetic)) : "";
  return tl::unexpected(outside_of(area, map.origin, in_words(metric) + as_degrees));
}

std::string text_of(const GivenPose& given) {
  return fmt::format("prior: x {:.3f} m, y {:.3f} m, yaw {:.3f} degrees in the map, read as {}\n",
                     given.pose.x_m, given.pose.y_m, degrees(given.pose.yaw_rad),
                     given.frame == PoseFrame::kMap ? "metres and degrees of its frame"
                                                    : "latitude, longitude and heading");
}

}  // namespace bevloc::evaluation
