#include "pipeline/tracker/arbiter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace bevloc {
namespace {

/// A match counts as agreeing for this long after it has passed the gate.
constexpr Duration kMatchLifetime = std::chrono::milliseconds(500);
/// GNSS samples after the start of a dispute that decide it.
constexpr size_t kDecidingSamples = 3;
/// GNSS confirms a pose up to this mean squared distance (three degrees of freedom): the 90 %
/// quantile of single samples. The other pose must be farther away by the second figure: its
/// likelihood is 90 times smaller.
constexpr double kConfirms = 6.25;
constexpr double kDecides = 9.0;
/// A match can tell whether the disputed offset exists if the squared distance of this offset, in
/// the covariance of the match, is at least this.
constexpr double kTelling = 9.0;
/// Refused GNSS samples in a row that exclude GNSS while the match agrees.
constexpr int kGnssRefusals = 5;
/// Squared distance of an innovation that no scatter explains: more than 6 standard deviations on
/// one axis. A single one begins a dispute.
constexpr double kFarOff = 40.0;
/// Passes in a row that readmit an excluded voter: one second of matches, two of GNSS.
constexpr int kMatchPasses = 10;
constexpr int kGnssPasses = 20;
/// Weight of a new innovation in the drift, and the limit of the drift in its own standard
/// deviations. The average of independent innovations has a variance of gain / (2 - gain).
constexpr double kDriftGain = 0.07;
constexpr double kDriftLimit = 4.0;
/// A lean is a mean deviation to one side, in its standard deviations. A bias of the yaw rate makes
/// match, GNSS and wheels lean to the same side. The arbiter assumes a bias if two or three of them
/// lean by more than kSharedLean, and their sum exceeds kSharedLimit standard deviations of the
/// sum.
constexpr double kSharedLean = 2.0;
constexpr double kSharedLimit = 3.5;
/// The match leans alone in heading, so dead reckoning does not drift, if GNSS leans to the other
/// side by more than kOpposingLean. A smaller lean of GNSS to that side suffices if the lean of the
/// wheels is known and is below kSupportingLean (positive to the side of the match).
constexpr double kOpposingLean = 1.5;
constexpr double kSupportingLean = 1.0;
/// The arbiter ignores the wheels for this long after they have helped to find a bias. They lean
/// until WheelDifference has learned it.
constexpr Duration kWheelMemory = std::chrono::seconds(30);
/// Larger innovations count as this many standard deviations, so that one outlier is no drift.
constexpr double kMaxDriftStep = 3.0;
/// Limit for the change of GNSS errors, in standard deviations.
constexpr double kGnssMoveLimit = 5.0;
/// Errors of odometry that OdometryMonitor does not find: of speed and yaw rate at once, and
/// growing.
constexpr double kOdometryError_mps = 0.6;
constexpr double kOdometryError_mps2 = 26.0;
constexpr double kOdometryError_radps = radians(2.0);
constexpr double kOdometryError_radps2 = radians(150.0);
/// Standard deviations of the offsets that a dispute is about: (m, m, rad).
const Eigen::Vector3d kPlausibleOffset{1.0, 1.0, radians(2.0)};
/// Disputes about smaller offsets need no decision, because the covariance of the pose covers them.
/// No offset is more than half the alert limit of a freeway: (m, m, rad).
const Eigen::Vector3d kHarmlessOffset{0.7, 0.28, radians(0.75)};
/// How long a verdict against dead reckoning lasts after the last contradiction.
constexpr Duration kOdometryMemory = std::chrono::seconds(1);

/// The offset of the pose that a match supports: an axis along which it sees little supports none.
Eigen::Vector3d supported_offset(const PoseInnovation& innovation) {
  const Eigen::Matrix3d plausible = kPlausibleOffset.cwiseAbs2().asDiagonal();
  return plausible * (plausible + innovation.covariance).ldlt().solve(innovation.error);
}

}  // namespace

void Arbiter::Voter::add(Time time, const PoseInnovation& innovation, bool passes_gate) {
  const Eigen::Vector3d sigma = innovation.covariance.diagonal().cwiseSqrt();
  far_off = !passes_gate && innovation.unexplained > kFarOff;
  const Eigen::Vector3d in_sigmas =
      innovation.error.cwiseQuotient(sigma).cwiseMax(-kMaxDriftStep).cwiseMin(kMaxDriftStep);
  // A measurement that does not see an axis says nothing about its drift.
  const auto seen = (sigma.array() <= kPlausibleOffset.array()).cast<double>();
  drift.array() += kDriftGain * seen * (in_sigmas - drift).array();
  if (passes_gate) {
    last_passed = time;
    last_passed_error = innovation.error;
    ++passed_in_a_row;
    refused_in_a_row = 0;
  } else {
    ++refused_in_a_row;
    passed_in_a_row = 0;
  }
}

Eigen::Vector3d Arbiter::Voter::lean() const {
  static const double sigma = std::sqrt(kDriftGain / (2.0 - kDriftGain));
  return drift / sigma;
}

bool Arbiter::Voter::drifts() const {
  return lean().cwiseAbs().maxCoeff() > kDriftLimit;
}

void Arbiter::Voter::exclude() {
  if (excluded) return;
  excluded = true;
  passed_in_a_row = 0;
}

bool Arbiter::Voter::readmit_after(int passes) {
  if (!excluded || passed_in_a_row < passes) return false;
  excluded = false;
  drift.setZero();
  return true;
}

double Arbiter::with_match(double lean) const {
  return std::copysign(lean, lean * match_.lean().z());
}

bool Arbiter::match_leans_alone() const {
  const double gnss = with_match(gnss_.lean().z());
  const bool wheels_deny = wheel_lean_ && with_match(*wheel_lean_) < kSupportingLean;
  return gnss < -kOpposingLean || (gnss < 0.0 && wheels_deny);
}

bool Arbiter::odometry_drifts() const {
  if (!match_.drifts()) return yaw_rate_drifts();
  return std::abs(match_.lean().z()) < kSharedLean || !match_leans_alone();
}

/// Whether at least two of match, GNSS and wheels say that the yaw rate has a bias.
bool Arbiter::yaw_rate_drifts() const {
  const std::array leans{match_.lean().z(), gnss_.lean().z(), wheel_lean_.value_or(0.0)};
  const auto agree_on = [&leans](double side) {
    int leaning = 0;
    double sum = 0.0;
    for (const double lean : leans) {
      if (side * lean <= kSharedLean) continue;
      ++leaning;
      sum += side * lean;
    }
    return leaning >= 2 && sum > kSharedLimit * std::sqrt(leaning);
  };
  return agree_on(-1.0) || agree_on(1.0);
}

/// Whether the heading of the match drifts, and dead reckoning is nearer to that of GNSS.
bool Arbiter::match_turns_alone() const {
  const double match = std::abs(match_.lean().z());
  return match > kDriftLimit && match > std::abs(gnss_.lean().z()) && match_leans_alone();
}

void Arbiter::forget_drift(Time now) {
  if (std::abs(wheel_lean_.value_or(0.0)) > kSharedLean) wheels_ignored_until_ = now + kWheelMemory;
  wheel_lean_.reset();
  match_.drift.setZero();
  gnss_.drift.setZero();
}

void Arbiter::add_odometry(Time time, const std::optional<double>& wheel_lean) {
  wheel_lean_ = wheel_lean;
  if (time < wheels_ignored_until_) wheel_lean_.reset();
}

void Arbiter::add_match(Time time, const PoseInnovation& innovation, bool passes_gate) {
  if (passes_gate && !answers_dispute(innovation)) return;
  const bool begins = !passes_gate && match_.refused_in_a_row == 0;
  if (begins) match_jumped_ = match_jumps(time, innovation);
  match_.add(time, innovation, passes_gate);
  if (passes_gate) explained_ = false;
  if (begins) dispute_since_ = time;
  if (!passes_gate) dispute_offset_ = supported_offset(innovation);
  match_.readmit_after(kMatchPasses);
}

/// Whether the match sees the disputed axis well enough to end the dispute. A match that sees
/// nothing along this axis leaves the dispute open.
bool Arbiter::answers_dispute(const PoseInnovation& innovation) const {
  return match_.refused_in_a_row == 0 ||
         squared_distance(dispute_offset_, innovation.covariance) >= kTelling;
}

/// Whether the match has moved against dead reckoning by more than undetected errors of odometry
/// explain: OdometryMonitor lets pass what a vehicle can do.
bool Arbiter::match_jumps(Time time, const PoseInnovation& innovation) const {
  if (!match_.last_passed) return false;
  const double elapsed_s = std::abs(to_seconds(time - *match_.last_passed));
  const double reach_m =
      kOdometryError_mps * elapsed_s + 0.5 * kOdometryError_mps2 * square_of(elapsed_s);
  const double reach_rad =
      kOdometryError_radps * elapsed_s + 0.5 * kOdometryError_radps2 * square_of(elapsed_s);
  const Eigen::Vector3d reach(reach_m, reach_m, reach_rad);
  const Eigen::Vector3d noise = 4.0 * innovation.covariance.diagonal().cwiseSqrt();
  const Eigen::Vector3d jump = (innovation.error - match_.last_passed_error).cwiseAbs();
  return ((jump - noise - reach).array() > 0.0).any();
}

void Arbiter::add_gnss(Time time, const PoseInnovation& innovation, bool passes_gate,
                       const std::optional<Eigen::Vector3d>& gnss_error) {
  gnss_.add(time, innovation, passes_gate);
  gnss_records_[gnss_count_++ % kGnssRecords] = {
      time, innovation.squared_distance,
      squared_distance(innovation.error - dispute_offset_, innovation.covariance)};
  if (!gnss_error) {
    forget_gnss_errors();
  } else if (!gnss_.excluded) {
    note_gnss_error(time, *gnss_error);
  }
  if (gnss_.readmit_after(kGnssPasses)) forget_gnss_errors();
}

void Arbiter::forget_gnss_errors() {
  gnss_error_count_ = 0;
  gnss_moved_ = false;
  gnss_.drift.setZero();
}

void Arbiter::note_gnss_error(Time time, const Eigen::Vector3d& gnss_error) {
  if (time < next_gnss_error_) return;
  next_gnss_error_ = time + std::chrono::seconds(1);
  gnss_moved_ = false;
  const size_t known = std::min(gnss_error_count_, kGnssErrors);
  for (size_t age = 1; age <= known; ++age) {
    const Eigen::Vector3d& before = gnss_errors_[(gnss_error_count_ - age) % kGnssErrors];
    const double expected =
        std::sqrt(2.0 * (1.0 - std::exp(-static_cast<double>(age) / gnss_correlation_s_)));
    const double change = (gnss_error - before).cwiseAbs().maxCoeff();
    gnss_moved_ = gnss_moved_ || change > kGnssMoveLimit * expected + 0.3;
  }
  gnss_errors_[gnss_error_count_++ % kGnssErrors] = gnss_error;
}

bool Arbiter::match_agrees(Time now) const {
  return match_.refused_in_a_row == 0 && match_.last_passed &&
         now - *match_.last_passed <= kMatchLifetime && !match_.excluded;
}

bool Arbiter::gnss_moved() const {
  return gnss_.refused_in_a_row >= kGnssRefusals || gnss_.drifts() || gnss_moved_;
}

Verdict Arbiter::judge(Time now, PoseStanding standing) {
  Verdict verdict;
  const bool valid = standing == PoseStanding::kValid;
  if (!valid) gnss_.excluded = false;
  if (match_is_disputed() && !match_.excluded) {
    decide_dispute(verdict, standing);
    if (verdict.odometry_contradicts) odometry_wrong_until_ = now + kOdometryMemory;
  }
  if (valid && match_turns_alone() && !gnss_.excluded) {
    exclude_match();
    match_.drift.setZero();
  }
  if (valid && match_agrees(now) && gnss_moved() && !odometry_drifts()) gnss_.exclude();
  if (!match_agrees(now) && !match_is_disputed() && gnss_.refused_in_a_row >= kGnssRefusals &&
      !gnss_.excluded) {
    verdict.undecided = true;
  }
  if (odometry_wrong_until_ && now < *odometry_wrong_until_) verdict.odometry_contradicts = true;
  if (match_.excluded) verdict.match_contradicts = true;
  if (gnss_.excluded) verdict.gnss_contradicts = true;
  return verdict;
}

void Arbiter::exclude_match() {
  match_.exclude();
  explained_ = true;
}

void Arbiter::decide_dispute(Verdict& verdict, PoseStanding standing) {
  if (explained_) return;
  const bool harmless = (dispute_offset_.cwiseAbs().array() < kHarmlessOffset.array()).all();
  if (harmless && standing == PoseStanding::kValid) return;
  if (standing == PoseStanding::kNew) {
    verdict.undecided = true;
    return;
  }
  if (match_jumped_) {
    exclude_match();
    return;
  }
  ask_gnss(verdict);
}

/// GNSS samples since the start of the dispute decide between the estimate, which dead reckoning
/// carries, and the pose of the match.
void Arbiter::ask_gnss(Verdict& verdict) {
  size_t samples = 0;
  double from_estimate = 0.0;
  double from_match = 0.0;
  for (size_t i = 0; i < std::min(gnss_count_, kGnssRecords); ++i) {
    const GnssRecord& record = gnss_records_[i];
    if (record.time <= dispute_since_) continue;
    ++samples;
    from_estimate += record.from_estimate;
    from_match += record.from_match;
  }
  if (samples < kDecidingSamples || gnss_.excluded) {
    verdict.undecided = true;
    return;
  }
  from_estimate /= static_cast<double>(samples);
  from_match /= static_cast<double>(samples);
  if (from_estimate < kConfirms && from_match - from_estimate > kDecides) {
    exclude_match();
  } else if (from_match < kConfirms && from_estimate - from_match > kDecides) {
    verdict.odometry_contradicts = true;
    explained_ = true;
  } else {
    verdict.undecided = true;
  }
}

std::optional<Eigen::Vector3d> Arbiter::open_dispute() const {
  if (!match_is_disputed() || match_.excluded) return std::nullopt;
  return dispute_offset_;
}

}  // namespace bevloc
