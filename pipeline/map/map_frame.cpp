#include "pipeline/map/map_frame.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <exception>
#include <numeric>
#include <optional>
#include <vector>

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/MGRS.hpp>
#include <GeographicLib/UTMUPS.hpp>

#include "common/median.h"
#include "pipeline/map/lanelet_geometry.h"
#include "pipeline/map/map_check.h"
#include "pipeline/map/tangent_plane.h"

namespace bevloc {
namespace {

bool has_local(const OsmNode& node) {
  return node.local_x_m && node.local_y_m;
}

/// Whether a node has latitude and longitude. Autoware's tools write "0" for both if a node has
/// local coordinates only.
bool has_angles(const OsmNode& node) {
  if (!node.latitude_deg || !node.longitude_deg) return false;
  return !has_local(node) || *node.latitude_deg != 0.0 || *node.longitude_deg != 0.0;
}

/// The middle of the values. It is their median if they lie farther apart than any map, so that a
/// few wrong values do not move it.
double middle_of(std::vector<double>& values_deg) {
  constexpr double kWidestMap_deg = 1.0;
  const auto [least, most] = std::ranges::minmax(values_deg);
  if (most - least <= kWidestMap_deg) return 0.5 * (least + most);
  return median(values_deg);
}

/// The middle of the nodes of all ways, as far as they have latitude and longitude.
std::optional<GeoOrigin> middle_of(const OsmDocument& document) {
  std::vector<double> latitudes_deg, longitudes_deg;
  for (const OsmWay& way : document.ways) {
    for (const int64_t id : way.nodes) {
      const auto node = document.nodes.find(id);
      if (node == document.nodes.end() || !has_angles(node->second)) continue;
      latitudes_deg.push_back(*node->second.latitude_deg);
      longitudes_deg.push_back(*node->second.longitude_deg);
    }
  }
  if (latitudes_deg.empty()) return std::nullopt;
  return GeoOrigin{middle_of(latitudes_deg), middle_of(longitudes_deg)};
}

/// Rotation, scale and shift of the plane. Points are complex numbers.
struct Similarity {
  std::complex<double> factor;
  std::complex<double> shift;

  std::complex<double> operator*(std::complex<double> point) const {
    return factor * point + shift;
  }
};

tl::unexpected<Error> too_few(size_t places, const std::string& file) {
  return fail(
      "{}: found lat and lon at some nodes, local_x and local_y at others, and both at {} places, "
      "wanted both at 2 places or more, or only one kind",
      file, places);
}

/// The least-squares similarity from local coordinates to the tangent plane. Fails if there are
/// fewer than two points or the fit is poor.
Result<Similarity> plane_from_local(const std::vector<std::complex<double>>& local,
                                    const std::vector<std::complex<double>>& plane,
                                    const std::string& file) {
  constexpr double kMaxScaleError = 0.01;
  constexpr double kMaxDisagreementM = 1.0;
  if (local.size() < 2) return too_few(local.size(), file);
  const auto count = static_cast<double>(local.size());
  const auto local_mean = std::accumulate(local.begin(), local.end(), std::complex(0.0)) / count;
  const auto plane_mean = std::accumulate(plane.begin(), plane.end(), std::complex(0.0)) / count;
  std::complex<double> covariance = 0.0;
  double variance = 0.0;
  for (size_t i = 0; i < local.size(); ++i) {
    covariance += std::conj(local[i] - local_mean) * (plane[i] - plane_mean);
    variance += std::norm(local[i] - local_mean);
  }
  if (variance == 0.0) return too_few(1, file);
  const std::complex<double> factor = covariance / variance;
  const Similarity transform{factor, plane_mean - factor * local_mean};
  double worst_m = 0.0;
  for (size_t i = 0; i < local.size(); ++i) {
    worst_m = std::max(worst_m, std::abs(transform * local[i] - plane[i]));
  }
  const bool agrees =
      std::abs(std::abs(factor) - 1.0) <= kMaxScaleError && worst_m <= kMaxDisagreementM;
  if (agrees) return transform;
  return fail(
      "{}: found local_x and local_y that differ from lat and lon by a scale of {:g} and up to "
      "{:g} "
      "m, wanted at most {:g} and {:g} m; remove the wrong ones",
      file, std::abs(factor), worst_m, 1.0 + kMaxScaleError, kMaxDisagreementM);
}

constexpr double kMgrsSquare_m = 100'000.0;

/// The place on earth of local coordinates in an MGRS square. Returns nothing if there is no such
/// square.
std::optional<GeoOrigin> place_in_square(const OsmNode& node) {
  try {
    int zone = 0, precision = 0;
    bool north = true;
    double east_m = 0.0, north_m = 0.0;
    constexpr bool kCenter = false;
    GeographicLib::MGRS::Reverse(node.mgrs_square, zone, north, east_m, north_m, precision,
                                 kCenter);
    if (precision != 0) return std::nullopt;
    GeoOrigin place;
    GeographicLib::UTMUPS::Reverse(zone, north, east_m + std::fmod(*node.local_x_m, kMgrsSquare_m),
                                   north_m + std::fmod(*node.local_y_m, kMgrsSquare_m),
                                   place.latitude_deg, place.longitude_deg);
    return place;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// Autoware's maps without latitude and longitude say in which MGRS square their local coordinates
/// are. Returns the document with the latitude and longitude of each node, or nothing if not all
/// nodes with local coordinates have a square.
std::optional<OsmDocument> with_angles_of_squares(const OsmDocument& document) {
  OsmDocument located = document;
  bool any = false;
  for (auto& [id, node] : located.nodes) {
    if (has_angles(node)) return std::nullopt;
    if (!has_local(node)) continue;
    const auto place = place_in_square(node);
    if (!place) return std::nullopt;
    node.latitude_deg = place->latitude_deg;
    node.longitude_deg = place->longitude_deg;
    node.local_x_m.reset();
    node.local_y_m.reset();
    any = true;
  }
  if (!any) return std::nullopt;
  return located;
}

}  // namespace

Result<NodePositions> locate_nodes(const OsmDocument& document) {
  if (const auto located = with_angles_of_squares(document)) return locate_nodes(*located);
  NodePositions positions;
  std::vector<std::complex<double>> local;
  std::vector<std::complex<double>> plane;
  if (const auto middle = middle_of(document)) {
    positions.origin = *middle;
    const GeographicLib::LocalCartesian tangent_plane(middle->latitude_deg, middle->longitude_deg);
    for (const auto& [id, node] : document.nodes) {
      if (!has_angles(node)) continue;
      const Eigen::Vector2d point =
          point_of(tangent_plane, {*node.latitude_deg, *node.longitude_deg});
      positions.of_node[id] = point;
      if (!has_local(node)) continue;
      local.emplace_back(*node.local_x_m, *node.local_y_m);
      plane.emplace_back(point.x(), point.y());
    }
  }
  if (std::none_of(document.nodes.begin(), document.nodes.end(),
                   [](const auto& entry) { return has_local(entry.second); })) {
    return positions;
  }
  std::optional<Similarity> transform;
  if (!positions.of_node.empty()) {
    Result<Similarity> fitted = plane_from_local(local, plane, document.file);
    if (!fitted) return tl::unexpected(fitted.error());
    transform = *fitted;
  }
  for (const auto& [id, node] : document.nodes) {
    if (!has_local(node)) continue;
    const std::complex<double> own(*node.local_x_m, *node.local_y_m);
    const std::complex<double> position = transform ? *transform * own : own;
    positions.of_node[id] = {position.real(), position.imag()};
  }
  return positions;
}

Result<std::vector<Eigen::Vector2d>> points_of(const OsmWay& way, const OsmDocument& document,
                                               const NodePositions& nodes) {
  std::vector<Eigen::Vector2d> points;
  for (const int64_t id : way.nodes) {
    const auto node = document.nodes.find(id);
    if (node == document.nodes.end()) {
      return fail(
          "{}:{}: way {}: found a reference to node {}, which is missing, wanted all its "
          "nodes in the file",
          document.file, way.line, way.id, id);
    }
    const auto position = nodes.of_node.find(id);
    if (position == nodes.of_node.end()) {
      return fail(
          "{}:{}: node {}: found no coordinates, wanted lat and lon, or local_x and "
          "local_y",
          document.file, node->second.line, id);
    }
    if (!is_near_origin(position->second)) {
      return fail(
          "{}:{}: node {}: found a place ({:g}, {:g}) m from the origin, wanted at most "
          "{:g} m",
          document.file, node->second.line, id, position->second.x(), position->second.y(),
          kFarthestFromOriginM);
    }
    if (points.empty() || points.back() != position->second) points.push_back(position->second);
  }
  return points;
}

std::optional<Eigen::Vector2d> shift_to_zero(NodePositions& nodes) {
  if (nodes.of_node.empty()) return std::nullopt;
  std::vector<Eigen::Vector2d> points;
  for (const auto& [id, position] : nodes.of_node) points.push_back(position);
  const Eigen::Vector2d middle = median_point(points);
  if (is_near_origin(middle)) return std::nullopt;
  const Eigen::Vector2d shift = -middle.array().round().matrix();
  for (auto& [id, position] : nodes.of_node) position += shift;
  return shift;
}

std::vector<double> heights_at(const std::vector<Eigen::Vector2d>& points,
                               const std::vector<const OsmWay*>& ways, const OsmDocument& document,
                               const NodePositions& nodes) {
  std::vector<double> heights_m;
  const auto height_of = [&](const Eigen::Vector2d& point) -> std::optional<double> {
    for (const OsmWay* way : ways) {
      for (const int64_t id : way->nodes) {
        if (nodes.of_node.at(id) == point) return document.nodes.at(id).height_m;
      }
    }
    return std::nullopt;
  };
  for (const Eigen::Vector2d& point : points) {
    const std::optional<double> height_m = height_of(point);
    if (!height_m) return {};
    heights_m.push_back(*height_m);
  }
  return heights_m;
}

std::vector<double> heights_of(const OsmWay& way, const OsmDocument& document,
                               const NodePositions& nodes, size_t count) {
  std::vector<double> heights_m;
  const Eigen::Vector2d* last = nullptr;
  for (const int64_t id : way.nodes) {
    const Eigen::Vector2d& position = nodes.of_node.at(id);
    const std::optional<double>& height_m = document.nodes.at(id).height_m;
    if (!height_m) return {};
    if (last == nullptr || *last != position) heights_m.push_back(*height_m);
    last = &position;
  }
  if (heights_m.size() != count) heights_m.clear();
  return heights_m;
}

}  // namespace bevloc
