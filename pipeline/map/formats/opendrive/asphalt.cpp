#include "pipeline/map/formats/opendrive/asphalt.h"

#include <utility>

namespace bevloc::opendrive {
namespace {

/// Gaps between the roads of a junction are narrower than this.
constexpr double kJunctionGap_m = 3.0;
constexpr double kGapStep_m = 0.5;

void pave_between(const Line3& right, const Line3& left, size_t road, std::vector<Area>& areas) {
  for (size_t i = 0; i + 1 < right.size(); ++i) {
    const bool has_width = (left[i] - right[i]).head<2>().norm() > kNoWidth_m ||
                           (left[i + 1] - right[i + 1]).head<2>().norm() > kNoWidth_m;
    if (has_width) areas.push_back({{right[i], right[i + 1], left[i + 1], left[i]}, {}, road});
  }
}

/// One quadrangle for each piece of neighbouring paved lanes.
std::vector<Area> paved_areas(const std::vector<CutSection>& sections) {
  std::vector<Area> areas;
  for (const CutSection& cut : sections) {
    const auto& lanes = cut.section->lanes;
    const auto counts = [](const LaneSpec& lane) { return is_paved(lane.type) || lane.id == 0; };
    for (size_t first = 0; first < lanes.size();) {
      if (!counts(lanes[first])) {
        ++first;
        continue;
      }
      size_t end = first + 1;
      while (end < lanes.size() && counts(lanes[end])) ++end;
      pave_between(cut.lines.borders[first], cut.lines.borders[end], cut.road_index, areas);
      first = end;
    }
  }
  return areas;
}

}  // namespace

Asphalt::Asphalt(const std::vector<CutSection>& sections) : cover_(paved_areas(sections)) {}

bool Asphalt::continues_beside(const CutSection& own, const Eigen::Vector3d& from,
                               const Eigen::Vector3d& to, bool left_paved) const {
  const Eigen::Vector2d along = (to - from).head<2>();
  const double length_m = along.norm();
  if (length_m == 0.0) return false;
  const Eigen::Vector2d left(-along.y() / length_m, along.x() / length_m);
  const Eigen::Vector2d outwards = (left_paved ? -1.0 : 1.0) * left;
  const auto beside = [&](double reach_m) {
    Eigen::Vector3d point = 0.5 * (from + to);
    point.head<2>() += reach_m * outwards;
    return point;
  };
  if (cover_.covers(beside(kBesideArea_m))) return true;
  if (!own.road->is_in_junction) return false;
  for (double reach_m = kGapStep_m; reach_m <= kJunctionGap_m; reach_m += kGapStep_m) {
    if (cover_.covers(beside(reach_m), own.road_index)) return true;
  }
  return false;
}

}  // namespace bevloc::opendrive
