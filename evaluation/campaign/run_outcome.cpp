#include "evaluation/campaign/run_outcome.h"

#include <bit>
#include <cmath>

#include "can/messages/message_table.h"
#include "common/alert_limits.h"

namespace bevloc::evaluation {
namespace {

/// How long the pose must have been right for the run to count as recovered.
constexpr double kRecovered_s = 1.0;
constexpr std::string_view kPrefix = "Why_";

std::string_view name_of_reason(Why reason) {
  constexpr size_t kInStatus = can::loc_status::kWhy.size();
  const auto bit = static_cast<size_t>(std::countr_zero(static_cast<uint32_t>(reason)));
  const can::Signal& signal =
      bit < kInStatus ? can::loc_status::kWhy[bit] : can::loc_integrity::kWhy[bit - kInStatus];
  return signal.name.substr(kPrefix.size());
}

}  // namespace

std::string names_of(WhyMask why) {
  std::string names;
  for_each_reason(why, [&](Why reason) {
    if (!names.empty()) names += '+';
    names += name_of_reason(reason);
  });
  return names;
}

double RunOutcome::valid_share() const {
  return cycles == 0 ? 0.0 : static_cast<double>(valid) / static_cast<double>(cycles);
}

double RunOutcome::beyond_alert_s() const {
  return to_seconds(kSolutionCycle) * static_cast<double>(beyond_alert);
}

RunOutcome RunJudge::outcome() const {
  RunOutcome outcome = outcome_;
  if (outcome.first_fix_s < 0.0 && !outcome.detection_s) outcome.detected_by = "never valid";
  return outcome;
}

RunJudge::RunJudge(const FaultTime& fault, WhyMask named_by) : fault_(fault), named_by_(named_by) {}

void RunJudge::add(const JudgedCycle& cycle) {
  if (latest_) {
    // Of a silent appliance, a receiver still has the state and the reasons, but no valid pose.
    JudgedCycle missing = *latest_;
    missing.pose.reset();
    for (const double time_s : missing_cycles_s(latest_->time_s, cycle.time_s)) {
      missing.time_s = time_s;
      take(missing);
    }
  }
  take(cycle);
  latest_ = cycle;
}

void RunJudge::take(const JudgedCycle& cycle) {
  note_state(cycle);
  if (cycle.pose) note_pose(cycle);
  const bool before_fault = cycle.time_s < fault_.from_s;
  // Why bits that are set because nothing has arrived yet are no detection of a fault from the
  // start.
  if (before_fault || !latest_) why_before_ = cycle.why;
  if (!before_fault) note_detection(cycle);
  if (cycle.time_s >= fault_.until_s) note_recovery(cycle);
  was_valid_ = cycle.pose.has_value();
}

void RunJudge::note_state(const JudgedCycle& cycle) {
  auto& timeline = outcome_.timeline;
  if (timeline.empty() || timeline.back().state != cycle.state ||
      timeline.back().why != cycle.why) {
    timeline.push_back({cycle.time_s, cycle.state, cycle.why});
  }
  if (cycle.pose && outcome_.first_fix_s < 0.0) outcome_.first_fix_s = cycle.time_s;
  if (outcome_.first_fix_s >= 0.0) ++outcome_.cycles;
  if (was_valid_ && !cycle.pose) {
    ++outcome_.lost;
    if (cycle.time_s < fault_.from_s) ++outcome_.false_lost;
  }
}

void RunJudge::note_pose(const JudgedCycle& cycle) {
  const JudgedError& pose = *cycle.pose;
  ++outcome_.valid;
  outcome_.worst = outcome_.worst.cwiseMax(pose.error.cwiseAbs());
  if (is_beyond(pose.error, kFreewayAlertLimits)) {
    ++outcome_.beyond_alert;
  }
  outcome_.protection.add(pose);
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<size_t>(i);
    const double error = std::abs(pose.error(i));
    for (size_t k = 0; k < outcome_.within_sigma.size(); ++k) {
      if (error <= static_cast<double>(k + 1) * pose.sigma(i)) ++outcome_.within_sigma[k][axis];
    }
  }
}

void RunJudge::note_detection(const JudgedCycle& cycle) {
  if (outcome_.detection_s) return;
  why_before_ = WhyMask::from_bits(why_before_.bits() & cycle.why.bits());
  const auto named = WhyMask::from_bits(cycle.why.bits() & named_by_.bits() & ~why_before_.bits());
  const bool lost = was_valid_ && !cycle.pose;
  if (named == WhyMask() && !lost) return;
  outcome_.detected_by = named == WhyMask() ? "not valid" : names_of(named);
  outcome_.detection_s = cycle.time_s - fault_.from_s;
}

void RunJudge::note_recovery(const JudgedCycle& cycle) {
  if (outcome_.recovery_s) return;
  const bool right = cycle.pose && !is_beyond(cycle.pose->error, kFreewayAlertLimits);
  if (!right) {
    good_since_s_.reset();
    return;
  }
  if (!good_since_s_) good_since_s_ = cycle.time_s;
  if (cycle.time_s - *good_since_s_ < kRecovered_s) return;
  outcome_.recovery_s = *good_since_s_ - fault_.until_s;
}

}  // namespace bevloc::evaluation
