// Computes the positions of OSM nodes in the map frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "common/result.h"
#include "pipeline/map/hd_map.h"
#include "pipeline/map/osm_document.h"

namespace bevloc {

struct NodePositions {
  GeoOrigin origin;
  /// Metres east and north of the origin. Contains neither nodes without coordinates nor nodes that
  /// no way uses.
  std::unordered_map<int64_t, Eigen::Vector2d> of_node;
  /// Names a node whose tag mgrs_code is needed but names no MGRS square, or is "".
  std::string remark{};
};

/// The map frame is the east-north tangent plane at the middle of the nodes of the file's ways.
/// Other nodes do not count. If any node has Autoware's local coordinates, a latitude and longitude
/// of 0 mean none. Where a node has Autoware's local coordinates, they take precedence over its
/// latitude and longitude: one similarity (shift, rotation, scale) maps all local coordinates into
/// the tangent plane. It is fitted to the nodes that have both. If no node has latitude and
/// longitude, but all with local coordinates have an MGRS square (tag mgrs_code), the local
/// coordinates are UTM coordinates within it. White space in the code does not count. If all have
/// the same square, they may go on up to 50 km beyond its border. Otherwise the local coordinates
/// are the map frame and the unknown origin is (0, 0).
///
/// Fails if some nodes have latitude and longitude, others local coordinates, and fewer than two at
/// different places have both. Fails, with line and node, if the two kinds disagree by more than 1
/// m or 1 % of scale.
Result<NodePositions> locate_nodes(const OsmDocument& document);

/// The points of a way, without consecutive duplicates. Fails if a node is missing, has no
/// position, or lies too far from the origin.
Result<std::vector<Eigen::Vector2d>> points_of(const OsmWay& way, const OsmDocument& document,
                                               const NodePositions& nodes);

/// The median of all positions, or (0, 0) without any.
Eigen::Vector2d middle_of(const NodePositions& nodes);

/// Moves the origin to the middle of the map, rounded to metres, if that is far from zero
/// (kFarFromZeroM), or if only then all of the map is near enough to the origin (is_near_origin()).
/// If the origin is known, the frame becomes the tangent plane there. Returns how the coordinates
/// were shifted, or nothing if they were not.
std::optional<Eigen::Vector2d> move_to_middle(NodePositions& nodes);

/// The heights of points that are nodes of these ways, or none if one of them has no height.
std::vector<double> heights_at(const std::vector<Eigen::Vector2d>& points,
                               const std::vector<const OsmWay*>& ways, const OsmDocument& document,
                               const NodePositions& nodes);

/// The heights of a way's nodes, without consecutive nodes at one place: one for each of `count`
/// points, or none if a node lacks its height. All nodes must have a position.
std::vector<double> heights_of(const OsmWay& way, const OsmDocument& document,
                               const NodePositions& nodes, size_t count);

}  // namespace bevloc
