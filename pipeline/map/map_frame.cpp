#include "pipeline/map/map_frame.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <optional>
#include <vector>

#include <GeographicLib/LocalCartesian.hpp>

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

/// The middle of all nodes with latitude and longitude.
std::optional<GeoOrigin> middle_of(const OsmDocument& document) {
  double south = 90.0, north = -90.0, west = 180.0, east = -180.0;
  for (const auto& [id, node] : document.nodes) {
    if (!has_angles(node)) continue;
    south = std::min(south, *node.latitude_deg);
    north = std::max(north, *node.latitude_deg);
    west = std::min(west, *node.longitude_deg);
    east = std::max(east, *node.longitude_deg);
  }
  if (south > north) return std::nullopt;
  return GeoOrigin{0.5 * (south + north), 0.5 * (west + east)};
}

/// Rotation, scale and shift of the plane. Points are complex numbers.
struct Similarity {
  std::complex<double> factor;
  std::complex<double> shift;

  std::complex<double> operator*(std::complex<double> point) const {
    return factor * point + shift;
  }
};

/// The least-squares similarity from local coordinates to the tangent plane. Nothing if there are
/// fewer than two points or the fit is poor.
std::optional<Similarity> plane_from_local(const std::vector<std::complex<double>>& local,
                                           const std::vector<std::complex<double>>& plane) {
  constexpr double kMaxScaleError = 0.01;
  constexpr double kMaxDisagreementM = 1.0;
  if (local.size() < 2) return std::nullopt;
  const auto count = static_cast<double>(local.size());
  const auto local_mean = std::accumulate(local.begin(), local.end(), std::complex(0.0)) / count;
  const auto plane_mean = std::accumulate(plane.begin(), plane.end(), std::complex(0.0)) / count;
  std::complex<double> covariance = 0.0;
  double variance = 0.0;
  for (size_t i = 0; i < local.size(); ++i) {
    covariance += std::conj(local[i] - local_mean) * (plane[i] - plane_mean);
    variance += std::norm(local[i] - local_mean);
  }
  if (variance == 0.0) return std::nullopt;
  const std::complex<double> factor = covariance / variance;
  const Similarity transform{factor, plane_mean - factor * local_mean};
  if (std::abs(std::abs(factor) - 1.0) > kMaxScaleError) return std::nullopt;
  for (size_t i = 0; i < local.size(); ++i) {
    if (std::abs(transform * local[i] - plane[i]) > kMaxDisagreementM) return std::nullopt;
  }
  return transform;
}

}  // namespace

NodePositions locate_nodes(const OsmDocument& document) {
  NodePositions positions;
  std::vector<std::complex<double>> local;
  std::vector<std::complex<double>> plane;
  if (const auto middle = middle_of(document)) {
    positions.origin = *middle;
    const GeographicLib::LocalCartesian tangent_plane(middle->latitude_deg, middle->longitude_deg);
    for (const auto& [id, node] : document.nodes) {
      if (!has_angles(node)) continue;
      double east_m = 0.0, north_m = 0.0, up_m = 0.0;
      tangent_plane.Forward(*node.latitude_deg, *node.longitude_deg, 0.0, east_m, north_m, up_m);
      positions.of_node[id] = {east_m, north_m};
      if (!has_local(node)) continue;
      local.emplace_back(*node.local_x_m, *node.local_y_m);
      plane.emplace_back(east_m, north_m);
    }
  }
  if (std::none_of(document.nodes.begin(), document.nodes.end(),
                   [](const auto& entry) { return has_local(entry.second); })) {
    return positions;
  }
  const auto transform = plane_from_local(local, plane);
  if (!transform) positions = {};
  for (const auto& [id, node] : document.nodes) {
    if (!has_local(node)) continue;
    const std::complex<double> own(*node.local_x_m, *node.local_y_m);
    const std::complex<double> position = transform ? *transform * own : own;
    positions.of_node[id] = {position.real(), position.imag()};
  }
  return positions;
}

}  // namespace bevloc
