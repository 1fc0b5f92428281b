#include "pipeline/map/formats/area_cover.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include "common/plane.h"
#include "pipeline/map/boost_box.h"

namespace bevloc {
namespace {

namespace geometry = boost::geometry;

using CoverEntry = std::pair<BoostBox, size_t>;

constexpr double kPiece_m = 0.5;
/// An edge is cut into at most this many pieces.
constexpr int kMostPieces = 10'000;

BoostBox box_of_ring(const Line3& ring) {
  Eigen::Vector2d low = ring.front().head<2>();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector3d& point : ring) {
    low = low.cwiseMin(point.head<2>());
    high = high.cwiseMax(point.head<2>());
  }
  return box_of(low, high);
}

bool is_in_area(const Eigen::Vector2d& point, const Area& area) {
  return is_in_ring(point, area.outer) &&
         std::ranges::none_of(area.holes,
                              [&point](const Line3& hole) { return is_in_ring(point, hole); });
}

/// The height of a ring where it is nearest to a point on the ground.
double height_of_ring(const Line3& ring, const Eigen::Vector2d& point) {
  double nearest_m2 = std::numeric_limits<double>::infinity();
  double height_m = std::numeric_limits<double>::quiet_NaN();
  for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Eigen::Vector3d edge = ring[i] - ring[j];
    const double length_m2 = edge.head<2>().squaredNorm();
    const double share =
        length_m2 > 0.0 ? (point - ring[j].head<2>()).dot(edge.head<2>()) / length_m2 : 0.0;
    const Eigen::Vector3d nearest = ring[j] + std::clamp(share, 0.0, 1.0) * edge;
    const double distance_m2 = (nearest.head<2>() - point).squaredNorm();
    if (distance_m2 >= nearest_m2) continue;
    nearest_m2 = distance_m2;
    height_m = nearest.z();
  }
  return height_m;
}

bool is_on_level(const Eigen::Vector3d& point, const Area& area) {
  if (!std::isfinite(point.z())) return true;
  const double apart_m = height_of_ring(area.outer, point.head<2>()) - point.z();
  return !std::isfinite(apart_m) || std::abs(apart_m) <= kSameLevel_m;
}

double doubled_area(const Line3& ring) {
  double sum = 0.0;
  for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    sum += cross(ring[j].head<2>(), ring[i].head<2>());
  }
  return sum;
}

/// The ring with the area to its left, closed by its first point.
Line3 directed(Line3 ring, bool is_hole) {
  if ((doubled_area(ring) > 0.0) == is_hole) std::ranges::reverse(ring);
  ring.push_back(ring.front());
  return ring;
}

/// Collects consecutive pieces into lines.
class PieceJoiner {
 public:
  void add(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    if (!open_) lines_.push_back({from});
    lines_.back().push_back(to);
    open_ = true;
  }
  void interrupt() { open_ = false; }

  /// Returns the lines. If the ring is free where it starts and ends, the last line and the first
  /// one are joined.
  std::vector<Line3> take() {
    if (lines_.size() > 1 && open_ && lines_.front().front() == lines_.back().back()) {
      lines_.back().insert(lines_.back().end(), lines_.front().begin() + 1, lines_.front().end());
      lines_.front() = std::move(lines_.back());
      lines_.pop_back();
    }
    return std::move(lines_);
  }

 private:
  std::vector<Line3> lines_;
  bool open_ = false;
};

}  // namespace

struct AreaCover::Tree {
  geometry::index::rtree<CoverEntry, geometry::index::quadratic<16>> boxes;
};

bool take_outline(const Line3& outline, const std::function<std::string()>& place,
                  MapBuilder& builder) {
  const double length_m = length_of(outline);
  if (length_m <= kLongestOutline_m) return true;
  builder.leave_out(fmt::format("{}: found an outline of {:g} m, wanted at most {:g} m", place(),
                                length_m, kLongestOutline_m));
  return false;
}

AreaCover::AreaCover(std::vector<Area> areas) : areas_(std::move(areas)) {
  std::vector<CoverEntry> entries;
  for (size_t i = 0; i < areas_.size(); ++i) {
    if (areas_[i].outer.size() > 2) entries.emplace_back(box_of_ring(areas_[i].outer), i);
    std::erase_if(areas_[i].holes, [](const Line3& hole) { return hole.size() < 3; });
  }
  tree_ = std::make_unique<const Tree>(Tree{decltype(Tree::boxes)(entries)});
}

AreaCover::AreaCover(AreaCover&&) noexcept = default;
AreaCover& AreaCover::operator=(AreaCover&&) noexcept = default;
AreaCover::~AreaCover() = default;

bool AreaCover::covers(const Eigen::Vector3d& point, std::optional<size_t> ignored_owner) const {
  const BoostBox at = box_of(point.head<2>(), point.head<2>());
  const auto is_here = geometry::index::satisfies([&](const CoverEntry& entry) {
    const Area& area = areas_[entry.second];
    return ignored_owner != area.owner && is_in_area(point.head<2>(), area) &&
           is_on_level(point, area);
  });
  return tree_->boxes.qbegin(geometry::index::intersects(at) && is_here) != tree_->boxes.qend();
}

std::vector<Line3> AreaCover::outline_of(size_t index) const {
  std::vector<Line3> outline;
  const Area& area = areas_[index];
  for (size_t r = 0; r <= area.holes.size(); ++r) {
    const Line3& source = r == 0 ? area.outer : area.holes[r - 1];
    if (source.size() < 3) continue;
    const Line3 ring = directed(source, r > 0);
    PieceJoiner joiner;
    for (size_t i = 0; i + 1 < ring.size(); ++i) {
      const Eigen::Vector3d edge = ring[i + 1] - ring[i];
      const double length_m = edge.head<2>().norm();
      if (length_m == 0.0) continue;
      const Eigen::Vector2d outwards(edge.y() / length_m, -edge.x() / length_m);
      const int pieces =
          static_cast<int>(std::clamp(std::ceil(length_m / kPiece_m), 1.0, double{kMostPieces}));
      for (int piece = 0; piece < pieces; ++piece) {
        const auto at = [&](double along) {
          return along == pieces ? ring[i + 1] : Eigen::Vector3d(ring[i] + along / pieces * edge);
        };
        Eigen::Vector3d beside = at(piece + 0.5);
        beside.head<2>() += kBesideArea_m * outwards;
        if (covers(beside)) {
          joiner.interrupt();
        } else {
          joiner.add(at(piece), at(piece + 1));
        }
      }
    }
    for (Line3& line : joiner.take()) outline.push_back(std::move(line));
  }
  return outline;
}

}  // namespace bevloc
