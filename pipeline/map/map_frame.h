// Where the nodes of an OSM file lie in the map frame.
#pragma once

#include <cstdint>
#include <unordered_map>

#include <Eigen/Core>

#include "common/result.h"
#include "pipeline/map/hd_map.h"
#include "pipeline/map/osm_document.h"

namespace bevloc {

struct NodePositions {
  GeoOrigin origin;
  /// Metres east and north of the origin; nodes without any coordinates are left out.
  std::unordered_map<int64_t, Eigen::Vector2d> of_node;
};

/// The map frame is the east-north tangent plane at the middle of the file's nodes. Autoware's
/// local coordinates, where a node has them, count more than its latitude and longitude: they are
/// moved, turned and scaled as a whole into that plane, as the nodes that have both tell. If no
/// node has both, or the two do not agree, local coordinates are the map frame as they are and the
/// origin, which nothing tells, is (0, 0).
NodePositions locate_nodes(const OsmDocument& document);

}  // namespace bevloc
