#include "sim/perception/visible_lines.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <optional>

#include "pipeline/bev_grid.h"

namespace bevloc::sim {
namespace {

constexpr double kSpacing_m = 0.5;
/// Elements of a map do not meet exactly, because each is surveyed on its own.
constexpr double kJointGap_m = 0.4;
constexpr double kJointBend_rad = radians(25.0);

using Points = std::vector<Eigen::Vector2d>;

Eigen::Vector2d half_box(double margin_m) {
  return {kRasterGrid.x_range_m() + margin_m, kRasterGrid.y_range_m() + margin_m};
}

/// Appends the stretches of a polyline that lie in the box. Cuts fall on the resampled points.
class BoxCutter {
 public:
  BoxCutter(const Eigen::Vector2d& half_box, std::vector<VisibleLine>& lines)
      : half_box_(half_box), lines_(lines) {}

  void cut(const VisibleLine& prototype, const DashedLine& line) {
    prototype_ = prototype;
    begin(line.points.front(), true);
    for (size_t i = 1; i < line.points.size(); ++i) {
      add_segment(line.points[i - 1], line.points[i], line.painted[i - 1]);
    }
    if (current_) current_->ends = true;
    finish();
  }

 private:
  void add_segment(const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool painted) {
    const bool misses = (from.cwiseMin(to).array() > half_box_.array()).any() ||
                        (from.cwiseMax(to).array() < -half_box_.array()).any();
    if (misses) return finish();
    const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / kSpacing_m)));
    for (int k = 1; k <= pieces; ++k) add(from + (to - from) * k / pieces, painted);
  }

  bool is_outside(const Eigen::Vector2d& point) const {
    return (point.array().abs() > half_box_.array()).any();
  }

  void begin(const Eigen::Vector2d& point, bool is_line_end) {
    if (is_outside(point)) return;
    current_ = prototype_;
    current_->begins = is_line_end;
    current_->points.push_back(point);
  }

  void add(const Eigen::Vector2d& point, bool painted) {
    if (!current_) return begin(point, false);
    if (is_outside(point)) return finish();
    current_->points.push_back(point);
    current_->painted.push_back(painted);
  }

  void finish() {
    if (current_ && current_->points.size() > 1) lines_.push_back(std::move(*current_));
    current_.reset();
  }

  Eigen::Vector2d half_box_;
  std::vector<VisibleLine>& lines_;
  VisibleLine prototype_;
  std::optional<VisibleLine> current_;
};

/// The two longest edges of a crossing, as in the rasterizer; the first ones if lengths are equal.
std::vector<Points> long_edges(const Points& ring) {
  std::vector<Points> edges;
  for (size_t i = 0; i < ring.size(); ++i) edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
  std::stable_sort(edges.begin(), edges.end(), [](const Points& a, const Points& b) {
    return (a[1] - a[0]).squaredNorm() > (b[1] - b[0]).squaredNorm();
  });
  edges.resize(std::min<size_t>(2, edges.size()));
  return edges;
}

void reverse(VisibleLine& line) {
  std::reverse(line.points.begin(), line.points.end());
  std::reverse(line.painted.begin(), line.painted.end());
  std::swap(line.begins, line.ends);
}

/// Whether `next` continues `line` at its end.
bool continues(const VisibleLine& line, const VisibleLine& next) {
  if (!line.ends || !next.begins || line.element_class != next.element_class) return false;
  if ((next.points.front() - line.points.back()).norm() > kJointGap_m) return false;
  const Eigen::Vector2d out = line.points.back() - line.points[line.points.size() - 2];
  const Eigen::Vector2d in = next.points[1] - next.points[0];
  return out.dot(in) > std::cos(kJointBend_rad) * out.norm() * in.norm();
}

/// Joins `other` to `line` if one continues the other. Either may run in the opposite direction.
bool join(VisibleLine& line, VisibleLine& other) {
  for (int turned = 0; turned < 4; ++turned) {
    if (continues(line, other)) {
      // Merge the two end points: a few centimetres apart, they would make a false bend.
      line.points.back() = 0.5 * (line.points.back() + other.points.front());
      line.points.insert(line.points.end(), std::next(other.points.begin()), other.points.end());
      line.painted.insert(line.painted.end(), other.painted.begin(), other.painted.end());
      line.ends = other.ends;
      line.of_ring = line.of_ring || other.of_ring;
      return true;
    }
    reverse(turned % 2 == 0 ? line : other);
  }
  return false;
}

/// Joins all lines that continue each other.
std::vector<VisibleLine> joined(std::vector<VisibleLine> lines) {
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].element_class == ElementClass::kPedestrianCrossing) continue;
    for (size_t k = i + 1; k < lines.size();) {
      if (join(lines[i], lines[k])) {
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(k));
        k = i + 1;
      } else {
        ++k;
      }
    }
    if (continues(lines[i], lines[i])) lines[i].begins = lines[i].ends = false;
  }
  return lines;
}

}  // namespace

std::vector<VisibleLine> visible_lines(const MapIndex& index, const Se2& map_from_vehicle,
                                       double margin_m, const MapDashes& dashes) {
  assert(dashes.empty() || dashes.size() == index.map().elements.size());
  const Eigen::Vector2d half = half_box(margin_m);
  std::vector<MapIndex::Segment> found;
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(half.norm());
  index.query(map_from_vehicle.translation() - reach, map_from_vehicle.translation() + reach,
              found);

  std::vector<VisibleLine> lines;
  BoxCutter cutter(half, lines);
  const Se2 vehicle_from_map = map_from_vehicle.inverse();
  for (size_t i = 0; i < found.size(); ++i) {
    if (i > 0 && found[i].element == found[i - 1].element) continue;
    const MapElement& element = index.map().elements[found[i].element];
    Points points;
    for (const Eigen::Vector2d& point : element.points) points.push_back(vehicle_from_map * point);
    VisibleLine prototype;
    prototype.element_class = element.element_class;
    prototype.element = found[i].element;
    if (element.element_class == ElementClass::kPedestrianCrossing) {
      for (const Points& edge : long_edges(points)) {
        cutter.cut(prototype, dashed_line(edge, {&kWholeLine, 1}));
      }
    } else {
      prototype.of_ring = (points.front() - points.back()).norm() < 1e-6;
      const std::span<const Dash> whole{&kWholeLine, 1};
      cutter.cut(prototype,
                 dashed_line(points, dashes.empty() ? whole : dashes[prototype.element]));
    }
  }
  return joined(std::move(lines));
}

}  // namespace bevloc::sim
