#include "pipeline/map/formats/projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <fmt/ranges.h>

#include "common/number_text.h"
#include "pipeline/map/tangent_plane.h"

namespace bevloc {
namespace {

/// Beyond this distance the series of the projections mean nothing.
constexpr double kFarthest_m = 2e7;

/// A transverse Mercator plane (EPSG method 9807).
class TransverseMercatorPlane : public Projection {
 public:
  struct Parameters {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double scale = 1.0;
    Eigen::Vector2d false_origin_m = Eigen::Vector2d::Zero();
  };

  explicit TransverseMercatorPlane(const Parameters& parameters)
      : parameters_(parameters), mercator_(6378137.0, 1.0 / 298.257223563, parameters.scale) {
    double east = 0.0;
    mercator_.Forward(parameters.longitude_deg, parameters.latitude_deg, parameters.longitude_deg,
                      east, north_of_origin_m_);
  }

  GeoOrigin geographic(const Eigen::Vector2d& point) const override {
    const Eigen::Vector2d plane = point - parameters_.false_origin_m;
    GeoOrigin place;
    mercator_.Reverse(parameters_.longitude_deg, plane.x(), plane.y() + north_of_origin_m_,
                      place.latitude_deg, place.longitude_deg);
    return place;
  }

  double distance_from_meridian_m(const Eigen::Vector2d& point) const override {
    return std::abs(point.x() - parameters_.false_origin_m.x());
  }

 private:
  Parameters parameters_;
  GeographicLib::TransverseMercator mercator_;
  double north_of_origin_m_ = 0.0;
};

class TangentPlane : public Projection {
 public:
  explicit TangentPlane(const GeoOrigin& origin)
      : plane_(origin.latitude_deg, origin.longitude_deg) {}

  GeoOrigin geographic(const Eigen::Vector2d& point) const override {
    return place_of(plane_, point);
  }

 private:
  GeographicLib::LocalCartesian plane_;
};

class MovedPlane : public Projection {
 public:
  MovedPlane(std::unique_ptr<Projection> inner, Eigen::Vector2d shift, double yaw_rad)
      : inner_(std::move(inner)), shift_(std::move(shift)) {
    rotation_ << std::cos(yaw_rad), -std::sin(yaw_rad), std::sin(yaw_rad), std::cos(yaw_rad);
  }

  GeoOrigin geographic(const Eigen::Vector2d& point) const override {
    return inner_->geographic(moved(point));
  }

  double distance_from_meridian_m(const Eigen::Vector2d& point) const override {
    return inner_->distance_from_meridian_m(moved(point));
  }

 private:
  Eigen::Vector2d moved(const Eigen::Vector2d& point) const { return rotation_ * point + shift_; }

  std::unique_ptr<Projection> inner_;
  Eigen::Matrix2d rotation_;
  Eigen::Vector2d shift_;
};

using ProjWords = std::map<std::string, std::string, std::less<>>;

ProjWords words_of(std::string_view text) {
  ProjWords words;
  constexpr std::string_view kSpace = " \t\r\n";
  while (true) {
    const size_t begin = text.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return words;
    const size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
    std::string_view word = text.substr(begin, end - begin);
    text.remove_prefix(end);
    if (word.starts_with('+')) word.remove_prefix(1);
    const size_t equals = std::min(word.find('='), word.size());
    const std::string_view value = word.substr(std::min(equals + 1, word.size()));
    words[std::string(word.substr(0, equals))] = value;
  }
}

/// The number of a word, or `fallback` where the word is missing.
Result<double> proj_number(const ProjWords& words, std::string_view key, double fallback,
                           double limit) {
  const auto word = words.find(key);
  if (word == words.end()) return fallback;
  const std::string& text = word->second;
  const auto value = parse_number<double>(text);
  if (value && std::abs(*value) <= limit) return *value;
  return fail("found +{}={}, wanted a number from {:g} to {:g}", key, text, -limit, limit);
}

/// Refuses a word whose value is none of `wanted`.
Status check_word(const ProjWords& words, std::string_view key,
                  std::initializer_list<std::string_view> wanted) {
  const auto word = words.find(key);
  if (word == words.end() || std::ranges::find(wanted, word->second) != wanted.end()) return {};
  return fail("found +{}={}, wanted {}", key, word->second, fmt::join(wanted, " or "));
}

/// Refuses words that are misspelt, or that would move the map and are not understood.
Status check_known(const ProjWords& words) {
  static constexpr std::array<std::string_view, 25> kKnown{
      "proj",    "zone", "south",      "lat_0",   "lon_0", "k",         "k_0",
      "x_0",     "y_0",  "datum",      "ellps",   "units", "to_meter",  "axis",
      "no_defs", "type", "wktext",     "vunits",  "pm",    "vto_meter", "approx",
      "towgs84", "over", "geoidgrids", "nadgrids"};
  for (const auto& [key, value] : words) {
    if (std::ranges::find(kKnown, key) != kKnown.end()) continue;
    return fail("found +{}{}{}, wanted only words of PROJ that bevloc knows (docs/maps.md)", key,
                value.empty() ? "" : "=", value);
  }
  const auto shift = words.find("towgs84");
  if (shift == words.end() || shift->second.find_first_not_of("0.,-") == std::string::npos) {
    return {};
  }
  return fail("found +towgs84={}, wanted a datum without a shift to WGS84", shift->second);
}

/// ETRS89 differs from WGS84 by less than a metre, and NAD83 by 1 m to 2 m.
Status check_datum(const ProjWords& words) {
  Status status = check_word(words, "datum", {"WGS84", "ETRS89", "NAD83"});
  if (status) status = check_word(words, "ellps", {"WGS84", "GRS80"});
  if (status) status = check_word(words, "units", {"m", "metre"});
  if (status) status = check_word(words, "to_meter", {"1", "1.0"});
  if (status) status = check_word(words, "axis", {"enu"});
  if (status) status = check_word(words, "pm", {"greenwich", "0"});
  if (status) status = check_word(words, "nadgrids", {"@null"});
  return status;
}

/// Replaces +init=epsg:NUMBER of a UTM zone by +proj=utm, +zone and +south. Leaves it where +proj
/// says something else.
Status resolve_epsg(ProjWords& words) {
  struct Zones {
    int first_code;
    int first_zone;
    int count;
    bool is_south;
  };
  // WGS 84 north and south, and ETRS89
  static constexpr std::array kZones{Zones{32601, 1, 60, false}, Zones{32701, 1, 60, true},
                                     Zones{25828, 28, 11, false}};
  const auto init = words.find("init");
  if (init == words.end() || words.contains("proj")) return {};
  std::string_view text = init->second;
  const bool is_epsg = text.starts_with("epsg:") || text.starts_with("EPSG:");
  const auto code = is_epsg ? parse_number<int>(text.substr(5)) : std::nullopt;
  const auto zones = std::ranges::find_if(kZones, [&](const Zones& some) {
    return code && *code >= some.first_code && *code < some.first_code + some.count;
  });
  if (zones == kZones.end()) {
    return fail(
        "found +init={}, wanted the EPSG code of a UTM zone (326xx, 327xx or 258xx), or +proj=utm "
        "or tmerc",
        text);
  }
  words.emplace("proj", "utm");
  words.emplace("zone", fmt::format("{}", zones->first_zone + *code - zones->first_code));
  if (zones->is_south) words.emplace("south", "");
  words.erase(init);
  return {};
}

Result<std::unique_ptr<Projection>> utm_plane(const ProjWords& words) {
  if (!words.contains("zone")) return fail("found no +zone, wanted 1 to 60");
  const Result<double> zone = proj_number(words, "zone", 0.0, 60.0);
  if (!zone) return tl::unexpected(zone.error());
  if (*zone < 1.0 || *zone != std::floor(*zone)) {
    return fail("found +zone={:g}, wanted 1 to 60", *zone);
  }
  return utm_projection(static_cast<int>(*zone), !words.contains("south"), {0.0, 0.0});
}

Result<std::unique_ptr<Projection>> transverse_mercator(const ProjWords& words) {
  TransverseMercatorPlane::Parameters parameters;
  const double own_scale = words.contains("k_0") ? 0.0 : 1.0;
  for (const auto& [key, limit, fallback, value] :
       {std::tuple<std::string_view, double, double, double*>{"lat_0", 90.0, 0.0,
                                                              &parameters.latitude_deg},
        {"lon_0", 180.0, 0.0, &parameters.longitude_deg},
        {own_scale > 0.0 ? "k" : "k_0", 2.0, 1.0, &parameters.scale},
        {"x_0", kFarthest_m, 0.0, &parameters.false_origin_m.x()},
        {"y_0", kFarthest_m, 0.0, &parameters.false_origin_m.y()}}) {
    const Result<double> number = proj_number(words, key, fallback, limit);
    if (!number) return tl::unexpected(number.error());
    *value = *number;
  }
  if (parameters.scale < 0.5)
    return fail("found a scale of {:g}, wanted 0.5 to 2", parameters.scale);
  return std::make_unique<TransverseMercatorPlane>(parameters);
}

}  // namespace

Result<std::unique_ptr<Projection>> projection_from_proj(std::string_view text) {
  ProjWords words = words_of(text);
  Status status = resolve_epsg(words);
  if (!status) return tl::unexpected(status.error());
  const auto kind = words.find("proj");
  if (kind == words.end()) {
    return fail("found \"{:.60}\", wanted a PROJ string with +proj=", text);
  }
  if (kind->second == "longlat" || kind->second == "latlong") return nullptr;
  const bool is_utm = kind->second == "utm";
  if (!is_utm && kind->second != "tmerc") {
    return fail("found +proj={}, wanted utm or tmerc", kind->second);
  }
  status = check_known(words);
  if (status) status = check_datum(words);
  if (!status) return tl::unexpected(status.error());
  return is_utm ? utm_plane(words) : transverse_mercator(words);
}

std::unique_ptr<Projection> utm_projection(int zone, bool north, const Eigen::Vector2d& offset) {
  constexpr double kCentralScale = 0.9996;
  const Eigen::Vector2d false_origin(500'000.0, north ? 0.0 : 10'000'000.0);
  return std::make_unique<TransverseMercatorPlane>(TransverseMercatorPlane::Parameters{
      0.0, 6.0 * zone - 183.0, kCentralScale, false_origin - offset});
}

Eigen::Vector2d utm_point(const GeoOrigin& place, int zone) {
  int found_zone = 0;
  bool north = true;
  Eigen::Vector2d point;
  GeographicLib::UTMUPS::Forward(place.latitude_deg, place.longitude_deg, found_zone, north,
                                 point.x(), point.y(), zone);
  return point;
}

std::unique_ptr<Projection> tangent_projection(const GeoOrigin& origin) {
  return std::make_unique<TangentPlane>(origin);
}

std::unique_ptr<Projection> moved_projection(std::unique_ptr<Projection> inner,
                                             const Eigen::Vector2d& shift, double yaw_rad) {
  return std::make_unique<MovedPlane>(std::move(inner), shift, yaw_rad);
}

}  // namespace bevloc
