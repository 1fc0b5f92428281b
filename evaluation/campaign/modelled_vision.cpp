#include "evaluation/campaign/modelled_vision.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/solver/posterior.h"

namespace bevloc::evaluation {
namespace {

constexpr double kFrameset_s = 0.1;
constexpr double kLatency_s = 0.03;
constexpr double kTurning_mps = 1.0;
/// Where two lanes look alike, the distribution has a second peak that is nearly as high.
constexpr double kRivalOfLaneAlike = 0.9;
/// In lane widths. A prior that is farther off finds the neighbouring lane. A search range that is
/// wider shows that lane as a second peak.
constexpr double kHalf = 0.5;

/// The solver's answer to pictures that show nothing.
MatchResult nothing_seen(const HypothesisGrid& hypotheses, Evidence evidence) {
  SolverResult result;
  set_no_evidence(hypotheses, result);
  result.evidence = evidence;
  return result;
}

}  // namespace

ModelledVision::ModelledVision(MatchModel model, std::shared_ptr<const sim::Drive> drive,
                               Time drive_start, Faults faults,
                               firmware::PredictionQueue& predictions,
                               firmware::VisionQueue& reports)
    : model_(std::move(model)),
      drive_(std::move(drive)),
      drive_start_(drive_start),
      faults_(std::move(faults)),
      priors_(false, predictions),
      reports_(reports),
      last_truth_(drive_->at(0.0).map_from_vehicle) {}

void ModelledVision::step(Time now) {
  priors_.take_predictions();
  const double due_s = to_seconds(now - drive_start_) - kLatency_s;
  while (frame_ * kFrameset_s <= due_s) report(kFrameset_s * frame_++);
}

const MatchFault* ModelledVision::active(MatchFaultKind kind, double time_s) const {
  if (time_s < faults_.time.from_s || time_s >= faults_.time.until_s) return nullptr;
  const auto found = std::ranges::find(faults_.faults, kind, &MatchFault::kind);
  return found == faults_.faults.end() ? nullptr : &*found;
}

void ModelledVision::report(double time_s) {
  const sim::Drive::State state = drive_->at(time_s);
  const Se2& truth = state.map_from_vehicle;
  distance_m_ += (truth.translation() - last_truth_.translation()).norm();
  last_truth_ = truth;

  const MatchFault* old_stamps = active(MatchFaultKind::kOldStamps, time_s);
  drivers::Frameset frameset;
  frameset.time = drive_start_ + from_seconds(time_s - (old_stamps ? old_stamps->delay_s : 0.0));
  firmware::VisionReport report;
  report.frame_time = frameset.time;
  report.present.set();
  const Time arrival = drive_start_ + from_seconds(time_s + kLatency_s);
  report.stamps_jumped =
      stamp_steps_.add(report.frame_time, arrival, static_cast<uint64_t>(frame_));
  report.stamp_jumps = stamp_steps_.jumps();
  if (const auto prior = priors_.at(frameset)) {
    report.had_prior = true;
    report.map_nearby = true;
    report.prior = prior->map_from_vehicle;
    report.match = match(report.prior, truth, prior->range, time_s);
  }
  reports_.push(report);
}

MatchResult ModelledVision::match(const Se2& prior, const Se2& truth, SearchRange range,
                                  double time_s) {
  const sim::Drive::State state = drive_->at(time_s);
  const double curvature_radpm =
      state.speed_mps > kTurning_mps ? state.yaw_rate_radps / state.speed_mps : 0.0;
  const MatchedPlace place{distance_m_, curvature_radpm};
  const Se2 wanted = correction_between(prior, truth);
  MatchResult result;
  if (active(MatchFaultKind::kNoEvidence, time_s)) {
    result = nothing_seen(model_.hypotheses(range), Evidence::kNone);
  } else if (active(MatchFaultKind::kSawNothing, time_s)) {
    result = nothing_seen(model_.hypotheses(range), Evidence::kGood);
  } else if (const auto* locked = active(MatchFaultKind::kLocked, time_s)) {
    result = model_.match_beside(place, range, wanted, locked->offset);
  } else if (const auto* creeping = active(MatchFaultKind::kCreeping, time_s)) {
    const double elapsed_s = time_s - faults_.time.from_s;
    const Se2& speed = creeping->offset;
    result = model_.match_beside(place, range, wanted,
                                 {elapsed_s * speed.x_m, elapsed_s * speed.y_m, 0.0});
  } else if (const auto* alike = active(MatchFaultKind::kLanesAlike, time_s)) {
    const double lane_m = alike->offset.y_m;
    const double lanes = std::floor(-wanted.y_m / lane_m + kHalf);
    result = model_.match(place, range, wanted * Se2{0.0, lanes * lane_m, 0.0});
    const bool sees_rival = model_.hypotheses(range).y_m.range > kHalf * lane_m;
    if (sees_rival) result.rival_peak.y() = std::max(result.rival_peak.y(), kRivalOfLaneAlike);
  } else {
    result = model_.match(place, range, wanted);
  }
  return result;
}

}  // namespace bevloc::evaluation
