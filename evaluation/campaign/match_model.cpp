#include "evaluation/campaign/match_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "common/normal_distribution.h"
#include "pipeline/solver/posterior.h"

namespace bevloc::evaluation {
namespace {

constexpr double kShortestBlock_m = 30.0;
constexpr double kLongestBlock_m = 90.0;
/// A vehicle counts as turning if the radius of its arc is less than 50 m.
constexpr double kTurning_radpm = 0.02;
/// Places this close count as one place of a standing vehicle.
constexpr double kSamePlace_m = 0.02;
/// The model looks for a match with a similar prior in this many framesets before and after the
/// place.
constexpr size_t kNeighbourhood = 12;
/// The cost of a match that is one frameset away. A prior that differs by one search range costs 1.
constexpr double kCostPerFrameset = 0.02;
/// Two priors whose errors differ by less than this part of the search range lead to the same place
/// of the map.
constexpr double kSamePeak = 0.5;
/// The cost of a match whose error differs by this much is 1, and so is the cost of a match that is
/// 1 / kCostPerFramesetBeside framesets away.
constexpr double kAlikeAlong_m = 0.5;
constexpr double kAlikeAcross_m = 0.15;
constexpr double kAlikeYaw_rad = radians(1.0);
constexpr double kCostPerFramesetBeside = 0.01;
/// A correction of more than this part of the search range was stopped by the border of the range.
constexpr double kAtBorder = 0.9;

std::array<double, 3> values_of(const Se2& pose) {
  return {pose.x_m, pose.y_m, pose.yaw_rad};
}

std::array<double, 3> ranges_of(const HypothesisGrid& grid) {
  return {grid.x_m.range, grid.y_m.range, grid.yaw_rad.range};
}

/// The part of a normal distribution that lies at the border of the axis, as edge_mass() counts it:
/// the last two hypotheses and everything beyond them.
double mass_at_border(double mean, double sigma, const HypothesisAxis& axis) {
  const double border = axis.farthest() - 1.5 * axis.step;
  return upper_tail((border - mean) / sigma) + upper_tail((border + mean) / sigma);
}

Eigen::Vector3d mass_at_border(const Se2& mean, const Eigen::Vector3d& sigma,
                               const HypothesisGrid& grid) {
  return {mass_at_border(mean.x_m, sigma.x(), grid.x_m),
          mass_at_border(mean.y_m, sigma.y(), grid.y_m),
          mass_at_border(mean.yaw_rad, sigma.z(), grid.yaw_rad)};
}

bool is_turning(double curvature_radpm) {
  return std::abs(curvature_radpm) > kTurning_radpm;
}

/// The first match of a place lies in the tracking range near the truth (record_matches()).
Se2 error_near_truth(const MeasuredPlace& place) {
  return place.matches.front().error();
}

/// The correction that a measured match gives from another prior, whose true correction is `truth`.
Se2 transfer(const MeasuredMatch& measured, const Se2& truth, const HypothesisGrid& grid) {
  const auto ranges = ranges_of(grid);
  const auto wanted = values_of(truth);
  const auto had = values_of(measured.truth);
  const auto found = values_of(measured.found);
  const auto same_peak = values_of(truth * measured.error());
  std::array<double, 3> correction{};
  for (size_t axis = 0; axis < 3; ++axis) {
    const bool stopped = std::abs(found[axis]) > kAtBorder * ranges[axis];
    const bool alike =
        std::abs(wanted[axis] - had[axis]) < kSamePeak * ranges[axis] ||
        (std::abs(wanted[axis]) < ranges[axis] && std::abs(had[axis]) < ranges[axis]);
    correction[axis] = alike && !stopped ? same_peak[axis] : found[axis];
  }
  return {correction[0], correction[1], correction[2]};
}

/// Says how badly a measured match fits a prior that is off by `wanted`. The match was measured
/// `framesets` away, from a prior that was off by `had`.
double cost_of(const Se2& had, size_t framesets, const Se2& wanted,
               const std::array<double, 3>& ranges) {
  const auto had_values = values_of(had);
  const auto wanted_values = values_of(wanted);
  double cost = kCostPerFrameset * static_cast<double>(framesets);
  for (size_t axis = 0; axis < 3; ++axis) {
    // Inside the range it hardly matters where the prior was.
    const double inside = ranges[axis] * kSamePeak;
    const bool both_inside =
        std::abs(wanted_values[axis]) < inside && std::abs(had_values[axis]) < inside;
    if (both_inside) continue;
    cost += std::pow((wanted_values[axis] - had_values[axis]) / ranges[axis], 2);
  }
  return cost;
}

/// The probability near the border of the search, per axis, if the peak of a measured match moves
/// to `peak`. It grows if the peak comes nearer to the border.
Eigen::Vector3d edge_mass_of(const MeasuredMatch& measured, const Se2& peak,
                             const HypothesisGrid& grid) {
  const Eigen::Vector3d sigma = measured.covariance().diagonal().cwiseSqrt();
  const Eigen::Vector3d more =
      mass_at_border(peak, sigma, grid) - mass_at_border(measured.found, sigma, grid);
  return (measured.edge_mass + more.cwiseMax(0.0)).cwiseMin(1.0);
}

}  // namespace

MatchModel::MatchModel(const MatchTable& table, const HypothesisGrid& tracking,
                       const HypothesisGrid& acquiring, uint64_t seed)
    : table_(table), tracking_(tracking), acquiring_(acquiring), random_(seed) {
  for (size_t i = 0; i < table_.places.size(); ++i) {
    starts_[is_turning(table_.places[i].curvature_radpm) ? 1 : 0].push_back(i);
  }
  collect_scatter();
}

void MatchModel::collect_scatter() {
  const auto& places = table_.places;
  for (size_t i = 1; i < places.size(); ++i) {
    const MeasuredPlace& a = places[i - 1];
    const MeasuredPlace& b = places[i];
    if (a.drive != b.drive || std::abs(b.station_m - a.station_m) > kSamePlace_m) continue;
    const Se2 first = error_near_truth(a);
    const Se2 second = error_near_truth(b);
    // The difference of two independent errors has sqrt(2) times the standard deviation of one
    // error.
    scatter_.push_back({(second.x_m - first.x_m) * std::numbers::sqrt2 / 2.0,
                        (second.y_m - first.y_m) * std::numbers::sqrt2 / 2.0,
                        wrap_angle(second.yaw_rad - first.yaw_rad) * std::numbers::sqrt2 / 2.0});
  }
}

MatchResult MatchModel::match(const MatchedPlace& place, SearchRange range, const Se2& truth) {
  follow(place);
  const HypothesisGrid& grid = hypotheses(range);
  const MeasuredMatch& measured = most_alike(range, truth);
  MatchResult result;
  result.evidence = Evidence::kGood;
  result.correction = transfer(measured, truth, grid);
  if (repeated_ && !scatter_.empty()) {
    const Se2& scatter = scatter_[random_.index(scatter_.size())];
    result.correction.x_m += scatter.x_m;
    result.correction.y_m += scatter.y_m;
    result.correction.yaw_rad += scatter.yaw_rad;
  }
  result.covariance = measured.covariance();
  result.edge_mass = edge_mass_of(measured, result.correction, grid);
  const auto ranges = ranges_of(grid);
  result.correction = {std::clamp(result.correction.x_m, -ranges[0], ranges[0]),
                       std::clamp(result.correction.y_m, -ranges[1], ranges[1]),
                       std::clamp(result.correction.yaw_rad, -ranges[2], ranges[2])};
  result.evidence_share =
      Eigen::Vector3d::Ones() - result.covariance.diagonal().cwiseQuotient(uniform_variance(grid));
  result.rival_peak = measured.rival_peak;
  result.score = measured.score;
  result.axis_score = measured.axis_score;
  return result;
}

MatchResult MatchModel::match_beside(const MatchedPlace& place, SearchRange range, const Se2& truth,
                                     const Se2& offset) {
  MatchResult result = match(place, range, Se2());
  result.correction = truth * offset * result.correction;
  const MeasuredMatch& measured = beside(offset);
  result.score = std::min(result.score, measured.score);
  result.axis_score = result.axis_score.cwiseMin(measured.axis_score);
  return result;
}

/// The measured match whose error is most like `offset`. Matches near the present place come first.
const MeasuredMatch& MatchModel::beside(const Se2& offset) const {
  const MeasuredMatch* best = nullptr;
  double least = std::numeric_limits<double>::max();
  for (size_t i = 0; i < table_.places.size(); ++i) {
    const double distance = static_cast<double>(i > at_ ? i - at_ : at_ - i);
    for (const MeasuredMatch& match : table_.places[i].matches) {
      const Se2 error = match.error();
      const double cost = std::abs(std::abs(error.x_m) - std::abs(offset.x_m)) / kAlikeAlong_m +
                          std::abs(std::abs(error.y_m) - std::abs(offset.y_m)) / kAlikeAcross_m +
                          std::abs(error.yaw_rad) / kAlikeYaw_rad +
                          kCostPerFramesetBeside * distance;
      if (cost < least) {
        least = cost;
        best = &match;
      }
    }
  }
  return *best;
}

void MatchModel::follow(const MatchedPlace& place) {
  const auto& places = table_.places;
  if (place.distance_m >= block_end_m_) begin_block(place);
  const double station_m = place.distance_m + offset_m_;
  size_t next = at_;
  while (next + 1 < places.size() && places[next + 1].drive == places[at_].drive &&
         places[next + 1].station_m <= station_m) {
    ++next;
  }
  const bool at_end = next + 1 == places.size() || places[next + 1].drive != places[at_].drive;
  if (at_end && station_m > places[next].station_m + kSamePlace_m) {
    begin_block(place);
    return;
  }
  repeated_ = next == at_;
  at_ = next;
}

void MatchModel::begin_block(const MatchedPlace& place) {
  const auto& alike = starts_[is_turning(place.curvature_radpm) ? 1 : 0];
  at_ = alike.empty() ? random_.index(table_.places.size()) : alike[random_.index(alike.size())];
  offset_m_ = table_.places[at_].station_m - place.distance_m;
  block_end_m_ = place.distance_m + random_.uniform(kShortestBlock_m, kLongestBlock_m);
  repeated_ = false;
}

const MeasuredMatch& MatchModel::most_alike(SearchRange range, const Se2& truth) const {
  const MeasuredMatch* best = nullptr;
  // The neighbourhood grows until it has a match of this range.
  for (size_t reach = kNeighbourhood; best == nullptr; reach *= 2) {
    assert(reach < 4 * table_.places.size() + 4 * kNeighbourhood);
    best = most_alike_within(reach, range, truth);
  }
  return *best;
}

const MeasuredMatch* MatchModel::most_alike_within(size_t reach, SearchRange range,
                                                   const Se2& truth) const {
  const auto ranges = ranges_of(hypotheses(range));
  const MeasuredMatch* best = nullptr;
  double least = std::numeric_limits<double>::max();
  const size_t first = at_ > reach ? at_ - reach : 0;
  const size_t last = std::min(at_ + reach, table_.places.size() - 1);
  for (size_t i = first; i <= last; ++i) {
    const MeasuredPlace& place = table_.places[i];
    if (place.drive != table_.places[at_].drive) continue;
    for (const MeasuredMatch& match : place.matches) {
      if (match.range != range) continue;
      const double cost = cost_of(match.truth, i > at_ ? i - at_ : at_ - i, truth, ranges);
      if (cost >= least) continue;
      least = cost;
      best = &match;
    }
  }
  return best;
}

}  // namespace bevloc::evaluation
