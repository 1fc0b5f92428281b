#include "pipeline/map/map_index.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include <boost/geometry/index/rtree.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <boost/iterator/function_output_iterator.hpp>

#include "pipeline/map/boost_box.h"

namespace bevloc {
namespace {

namespace bgi = boost::geometry::index;
using Entry = std::pair<BoostBox, MapIndex::Segment>;

BoostBox box_around(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return box_of(a.cwiseMin(b), a.cwiseMax(b));
}

std::vector<Entry> segments_of(const HdMap& map) {
  std::vector<Entry> entries;
  for (uint32_t e = 0; e < map.elements.size(); ++e) {
    const MapElement& element = map.elements[e];
    for (uint32_t i = 0; i < segment_count(element); ++i) {
      entries.emplace_back(box_around(element.points[i], segment_end(element, i)),
                           MapIndex::Segment{e, i});
    }
  }
  return entries;
}

}  // namespace

struct MapIndex::Tree {
  bgi::rtree<Entry, bgi::rstar<16>> segments;
};

MapIndex::MapIndex(const HdMap& map)
    : map_(map),
      tree_(
          std::make_unique<const Tree>(Tree{bgi::rtree<Entry, bgi::rstar<16>>(segments_of(map))})) {
}

MapIndex::~MapIndex() = default;

void MapIndex::query(const Eigen::Vector2d& min_corner, const Eigen::Vector2d& max_corner,
                     std::vector<Segment>& found) const {
  found.clear();
  tree_->segments.query(bgi::intersects(box_around(min_corner, max_corner)),
                        boost::make_function_output_iterator(
                            [&found](const Entry& entry) { found.push_back(entry.second); }));
  std::sort(found.begin(), found.end(), [](const Segment& a, const Segment& b) {
    return std::tie(a.element, a.first) < std::tie(b.element, b.first);
  });
}

}  // namespace bevloc
