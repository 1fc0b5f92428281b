#include "pipeline/map/line_neighbours.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include "common/plane.h"
#include "pipeline/map/boost_box.h"

namespace bevloc {
namespace {

namespace geometry = boost::geometry;

/// A line is examined at points this far apart.
constexpr double kSpacing_m = 0.5;

/// Calls visit(point) along a line, at the middle of pieces of equal length in each segment.
template <typename Visit>
void for_each_point(const std::vector<Eigen::Vector2d>& line, Visit visit) {
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d along = line[i + 1] - line[i];
    const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / kSpacing_m)));
    for (int piece = 0; piece < pieces; ++piece) {
      visit(Eigen::Vector2d(line[i] + (piece + 0.5) / pieces * along));
    }
  }
}

}  // namespace

struct LineNeighbours::Index {
  using Entry = std::pair<BoostBox, size_t>;

  std::vector<Segment> segments;
  geometry::index::rtree<Entry, geometry::index::quadratic<16>> boxes;
};

LineNeighbours::LineNeighbours() : index_(std::make_unique<Index>()) {}
LineNeighbours::~LineNeighbours() = default;

void LineNeighbours::add(int64_t id, const std::vector<Eigen::Vector2d>& line) {
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const BoostBox box = box_of(line[i].cwiseMin(line[i + 1]), line[i].cwiseMax(line[i + 1]));
    index_->boxes.insert({box, index_->segments.size()});
    index_->segments.push_back({line[i], line[i + 1], id});
  }
}

double LineNeighbours::share_beside(const std::vector<Eigen::Vector2d>& line, double reach_m,
                                    const std::function<bool(int64_t)>& counts) const {
  int points = 0;
  int near = 0;
  const auto has_right_id = [&](const Segment& segment) { return counts(segment.id); };
  for_each_point(line, [&](const Eigen::Vector2d& point) {
    ++points;
    near += has_near(point, reach_m, has_right_id) ? 1 : 0;
  });
  return points > 0 ? static_cast<double>(near) / points : 0.0;
}

bool LineNeighbours::has_near(const Eigen::Vector2d& point, double reach_m,
                              const std::function<bool(const Segment&)>& counts) const {
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(reach_m);
  const auto is_near = geometry::index::satisfies([&](const Index::Entry& entry) {
    const Segment& segment = index_->segments[entry.second];
    return counts(segment) && distance_to_segment(point, segment.from, segment.to) <= reach_m;
  });
  const BoostBox around = box_of(point - reach, point + reach);
  return index_->boxes.qbegin(geometry::index::intersects(around) && is_near) !=
         index_->boxes.qend();
}

}  // namespace bevloc
