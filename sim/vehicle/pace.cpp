#include "sim/vehicle/pace.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace bevloc::sim {
namespace {

/// The moment `elapsed_s` after this one, if the pace goes on changing at the same rate.
Pace::Moment later(const Pace::Moment& moment, double elapsed_s) {
  return {.planned_s = moment.planned_s + elapsed_s * moment.pace +
                       0.5 * elapsed_s * elapsed_s * moment.change_per_s,
          .pace = moment.pace + elapsed_s * moment.change_per_s,
          .change_per_s = moment.change_per_s};
}

}  // namespace

Pace::Pace(std::vector<PacePoint> points) {
  if (points.empty()) return;
  pieces_.push_back({0.0, {.pace = points.front().pace}});
  for (size_t i = 0; i < points.size(); ++i) {
    const Piece& before = pieces_.back();
    Moment start = later(before.start, points[i].at_s - before.from_s);
    start.pace = points[i].pace;  // exact, without the rounding errors of later()
    start.change_per_s = 0.0;
    if (i + 1 < points.size()) {
      assert(points[i + 1].at_s > points[i].at_s);
      start.change_per_s =
          (points[i + 1].pace - points[i].pace) / (points[i + 1].at_s - points[i].at_s);
    }
    pieces_.push_back({points[i].at_s, start});
  }
}

Pace::Moment Pace::at(double time_s) const {
  if (pieces_.empty()) return {.planned_s = time_s};
  const auto after = std::ranges::upper_bound(pieces_, time_s, {}, &Piece::from_s);
  const Piece& piece = after == pieces_.begin() ? pieces_.front() : *std::prev(after);
  return later(piece.start, time_s - piece.from_s);
}

double Pace::earliest_planned_s(double until_s) const {
  double earliest_s = std::min(0.0, at(until_s).planned_s);
  for (size_t i = 0; i < pieces_.size() && pieces_[i].from_s <= until_s; ++i) {
    const auto& [from_s, start] = pieces_[i];
    earliest_s = std::min(earliest_s, start.planned_s);
    // Within a piece the vehicle is farthest back where it stops reversing.
    if (start.pace >= 0.0 || start.change_per_s <= 0.0) continue;
    const double turning_s = -start.pace / start.change_per_s;
    const double end_s =
        i + 1 < pieces_.size() ? std::min(until_s, pieces_[i + 1].from_s) : until_s;
    if (from_s + turning_s > end_s) continue;
    earliest_s = std::min(earliest_s, later(start, turning_s).planned_s);
  }
  return earliest_s;
}

}  // namespace bevloc::sim
