#include "pipeline/map/map_frame.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <exception>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
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

/// A node of a way, with those of its coordinates that count.
struct UsedNode {
  int64_t id = 0;
  int line = 0;
  std::optional<GeoOrigin> place{};
  std::optional<std::complex<double>> local_m{};
  std::string mgrs_square{};
};

bool has_local(const UsedNode& node) {
  return node.local_m.has_value();
}

/// The nodes of all ways, each once. Nodes that no way uses do not count, whatever they say.
std::vector<UsedNode> used_nodes(const OsmDocument& document) {
  std::vector<UsedNode> used;
  std::unordered_set<int64_t> seen;
  for (const OsmWay& way : document.ways) {
    for (const int64_t id : way.nodes) {
      const auto found = document.nodes.find(id);
      if (found == document.nodes.end() || !seen.insert(id).second) continue;
      const OsmNode& node = found->second;
      UsedNode& own = used.emplace_back();
      own.id = id;
      own.line = node.line;
      own.mgrs_square = node.mgrs_square;
      if (node.local_x_m && node.local_y_m) own.local_m = {*node.local_x_m, *node.local_y_m};
      if (node.latitude_deg && node.longitude_deg) {
        own.place = GeoOrigin{*node.latitude_deg, *node.longitude_deg};
      }
    }
  }
  if (std::ranges::none_of(used, has_local)) return used;
  // Autoware's tools write "0" for the latitude and longitude that they do not know.
  for (UsedNode& node : used) {
    if (node.place && !is_known(*node.place)) node.place.reset();
  }
  return used;
}

/// The middle of the values. It is their median if they lie farther apart than any map, so that a
/// few wrong values do not move it.
double middle_of(std::vector<double>& values_deg) {
  constexpr double kWidestMap_deg = 1.0;
  const auto [least, most] = std::ranges::minmax(values_deg);
  if (most - least <= kWidestMap_deg) return 0.5 * (least + most);
  return median(values_deg);
}

/// The middle of the nodes that have a place on earth, if there are any.
std::optional<GeoOrigin> middle_of(const std::vector<UsedNode>& nodes) {
  std::vector<double> latitudes_deg, longitudes_deg;
  for (const UsedNode& node : nodes) {
    if (!node.place) continue;
    latitudes_deg.push_back(node.place->latitude_deg);
    longitudes_deg.push_back(node.place->longitude_deg);
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

/// A node that has both kinds of coordinates.
struct LocatedNode {
  const UsedNode* node = nullptr;
  std::complex<double> local;
  std::complex<double> plane;
};

/// The least-squares similarity from local coordinates to the tangent plane.
struct Fit {
  Similarity plane_from_local;
  std::complex<double> local_mean;
  double variance = 0.0;  ///< the sum of the squared distances from the mean, m2

  double error_m(const LocatedNode& node) const {
    return std::abs(plane_from_local * node.local - node.plane);
  }
};

/// The node without which the sum of the squared errors shrinks most. Its own error may be small,
/// because a node far from the others pulls the fit to itself.
const UsedNode& worst_node(const Fit& fit, const std::vector<LocatedNode>& nodes) {
  constexpr double kLeastShare = 1e-15;
  const auto gain_m2 = [&](const LocatedNode& node) {
    const double leverage = 1.0 / static_cast<double>(nodes.size()) +
                            std::norm(node.local - fit.local_mean) / fit.variance;
    return std::pow(fit.error_m(node), 2) / std::max(1.0 - leverage, kLeastShare);
  };
  return *std::ranges::max_element(nodes, {}, gain_m2)->node;
}

/// Refuses local coordinates that do not fit the others.
Status check_fit(const Fit& fit, const std::vector<LocatedNode>& nodes, const std::string& file) {
  constexpr double kMaxScaleError = 0.01;
  constexpr double kMaxDisagreementM = 1.0;
  double most_m = 0.0;
  for (const LocatedNode& node : nodes) most_m = std::max(most_m, fit.error_m(node));
  const double scale = std::abs(fit.plane_from_local.factor);
  if (std::abs(scale - 1.0) <= kMaxScaleError && most_m <= kMaxDisagreementM) return {};
  const UsedNode& worst = worst_node(fit, nodes);
  return fail(
      "{}:{}: node {}: found local_x and local_y that differ from lat and lon by a scale of {:g} "
      "and up to {:g} m in the whole file, wanted at most {:g} and {:g} m; correct this node, "
      "which fits worst, or remove local_x and local_y from all nodes: a map over the border of an "
      "MGRS square needs lat and lon alone",
      file, worst.line, worst.id, scale, most_m, 1.0 + kMaxScaleError, kMaxDisagreementM);
}

/// Fails if there are fewer than two places or the fit is poor.
Result<Similarity> fit_plane_from_local(const std::vector<LocatedNode>& nodes,
                                        const std::string& file) {
  if (nodes.size() < 2) return too_few(nodes.size(), file);
  const auto count = static_cast<double>(nodes.size());
  Fit fit;
  std::complex<double> plane_mean = 0.0;
  for (const LocatedNode& node : nodes) {
    fit.local_mean += node.local;
    plane_mean += node.plane;
  }
  fit.local_mean /= count;
  plane_mean /= count;
  std::complex<double> covariance = 0.0;
  for (const LocatedNode& node : nodes) {
    covariance += std::conj(node.local - fit.local_mean) * (node.plane - plane_mean);
    fit.variance += std::norm(node.local - fit.local_mean);
  }
  if (fit.variance == 0.0) return too_few(1, file);
  const std::complex<double> factor = covariance / fit.variance;
  fit.plane_from_local = {factor, plane_mean - factor * fit.local_mean};
  const Status status = check_fit(fit, nodes, file);
  if (!status) return tl::unexpected(status.error());
  return fit.plane_from_local;
}

constexpr double kMgrsSquare_m = 100'000.0;

/// Local coordinates as metres from the south-western corner of their square. The coordinates of a
/// map in one square may go on beyond the border of the square. All other values are those of the
/// UTM zone, or of several squares.
std::complex<double> within_square(std::complex<double> local_m, bool is_one_square) {
  const auto may_go_on = [](double value_m) {
    return value_m >= -0.5 * kMgrsSquare_m && value_m <= 1.5 * kMgrsSquare_m;
  };
  if (is_one_square && may_go_on(local_m.real()) && may_go_on(local_m.imag())) return local_m;
  return {std::fmod(local_m.real(), kMgrsSquare_m), std::fmod(local_m.imag(), kMgrsSquare_m)};
}

/// The place on earth of a point in an MGRS square. Returns nothing if there is no such square.
std::optional<GeoOrigin> place_in_square(const std::string& square, std::complex<double> point_m) {
  try {
    int zone = 0, precision = 0;
    bool north = true;
    double east_m = 0.0, north_m = 0.0;
    constexpr bool kCenter = false;
    GeographicLib::MGRS::Reverse(square, zone, north, east_m, north_m, precision, kCenter);
    if (precision != 0) return std::nullopt;
    GeoOrigin place;
    GeographicLib::UTMUPS::Reverse(zone, north, east_m + point_m.real(), north_m + point_m.imag(),
                                   place.latitude_deg, place.longitude_deg);
    return place;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

/// Autoware's maps without latitude and longitude say in which MGRS square their local coordinates
/// are. Replaces the local coordinates by places, unless a node has a place already, or a node with
/// local coordinates names no square. Returns a remark if it names one that does not exist.
std::string place_in_squares(std::vector<UsedNode>& nodes, const std::string& file) {
  std::vector<UsedNode> placed = nodes;
  const auto first = std::ranges::find_if(placed, has_local);
  if (first == placed.end()) return "";
  const bool is_one_square = std::ranges::all_of(placed, [&](const UsedNode& node) {
    return !node.local_m || node.mgrs_square == first->mgrs_square;
  });
  for (UsedNode& node : placed) {
    if (node.place) return "";
    if (!node.local_m) continue;
    node.place = place_in_square(node.mgrs_square, within_square(*node.local_m, is_one_square));
    if (node.place) continue;
    if (node.mgrs_square.empty()) return "";
    return fmt::format(
        "{}:{}: node {}: found an mgrs_code of the square \"{:.20}\", which does not exist, wanted "
        "one such as 54SUE, from which the map gets its place on earth",
        file, node.line, node.id, node.mgrs_square);
  }
  for (UsedNode& node : placed) node.local_m.reset();
  nodes = std::move(placed);
  return "";
}

}  // namespace

Result<NodePositions> locate_nodes(const OsmDocument& document) {
  std::vector<UsedNode> nodes = used_nodes(document);
  NodePositions positions;
  positions.remark = place_in_squares(nodes, document.file);
  std::vector<LocatedNode> with_both;
  if (const auto middle = middle_of(nodes)) {
    positions.origin = *middle;
    const GeographicLib::LocalCartesian tangent_plane(middle->latitude_deg, middle->longitude_deg);
    for (const UsedNode& node : nodes) {
      if (!node.place) continue;
      const Eigen::Vector2d point = point_of(tangent_plane, *node.place);
      positions.of_node[node.id] = point;
      if (node.local_m) with_both.push_back({&node, *node.local_m, {point.x(), point.y()}});
    }
  }
  if (std::ranges::none_of(nodes, has_local)) return positions;
  Similarity plane_from_local{1.0, 0.0};
  if (!positions.of_node.empty()) {
    const Result<Similarity> fitted = fit_plane_from_local(with_both, document.file);
    if (!fitted) return tl::unexpected(fitted.error());
    plane_from_local = *fitted;
  }
  for (const UsedNode& node : nodes) {
    if (!node.local_m) continue;
    const std::complex<double> position = plane_from_local * *node.local_m;
    positions.of_node[node.id] = {position.real(), position.imag()};
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

Eigen::Vector2d middle_of(const NodePositions& nodes) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& [id, position] : nodes.of_node) points.push_back(position);
  return points.empty() ? Eigen::Vector2d(0.0, 0.0) : median_point(points);
}

std::optional<Eigen::Vector2d> move_to_middle(NodePositions& nodes) {
  const Eigen::Vector2d shift = -middle_of(nodes).array().round().matrix();
  const auto comes_near = [&](const auto& node) {
    return !is_near_origin(node.second) && is_near_origin(node.second + shift);
  };
  if (shift.norm() <= kFarFromZeroM && std::ranges::none_of(nodes.of_node, comes_near)) {
    return std::nullopt;
  }
  if (!is_known(nodes.origin)) {
    for (auto& [id, position] : nodes.of_node) position += shift;
    return shift;
  }
  const GeographicLib::LocalCartesian old_plane(nodes.origin.latitude_deg,
                                                nodes.origin.longitude_deg);
  nodes.origin = place_of(old_plane, -shift);
  const GeographicLib::LocalCartesian plane(nodes.origin.latitude_deg, nodes.origin.longitude_deg);
  for (auto& [id, position] : nodes.of_node) {
    position = point_of(plane, place_of(old_plane, position));
  }
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
