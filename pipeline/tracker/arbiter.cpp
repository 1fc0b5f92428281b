#include "pipeline/tracker/arbiter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace bevloc {
namespace {

/// A match counts as agreeing for this long after it has passed the gate.
constexpr Duration kMatchLifetime = std::chrono::milliseconds(500);
/// The number of GNSS samples after the start of a dispute that decide it.
constexpr size_t kDecidingSamples = 3;
/// GNSS confirms a pose up to this mean squared distance (three degrees of freedom): the 90 %
/// quantile of single samples. The other pose must be farther away by kDecides, so that its
/// likelihood is 90 times smaller.
constexpr double kConfirms = 6.25;
constexpr double kDecides = 9.0;
/// A match can tell whether the disputed offset exists if the squared distance of this offset, in
/// the covariance of the match, is at least this.
constexpr double kTelling = 9.0;
/// Squared distance of an innovation that no scatter explains: more than 6 standard deviations on
/// one axis. A single one begins a dispute.
constexpr double kFarOff = 40.0;
/// An excluded voter counts again once this many of its measurements in a row agree with the
/// filter. That takes one second for matches and two seconds for GNSS.
constexpr int kMatchesToReadmit = 10;
constexpr int kGnssToReadmit = 20;
/// A measurement agrees with the filter if its squared distance is at most this limit. 97 % of
/// independent measurements agree. The limit is smaller than that of the gate, because the
/// covariance grows while a voter is excluded, and a wrong voter could then pass the gate.
constexpr double kAgrees = 9.0;
/// Weight of a new innovation in the drift, and the limit of the drift in its own standard
/// deviations. The average of independent innovations has a variance of gain / (2 - gain).
constexpr double kDriftGain = 0.07;
constexpr double kDriftLimit = 4.0;
/// A lean is a mean deviation to one side, in its standard deviations. A bias of the yaw rate makes
/// match, GNSS and wheels lean to the same side. The arbiter assumes a bias if two of them lean by
/// more than kSharedLean, or all three by more than kLeanOfThree, and the sum of those that lean
/// exceeds kSharedLimit standard deviations of the sum.
constexpr double kSharedLean = 2.0;
constexpr double kLeanOfThree = 1.0;
constexpr double kSharedLimit = 3.5;
/// If the heading of GNSS leans to the other side than that of the match by more than
/// kOpposingLean, the match leans alone and dead reckoning does not drift. If the wheels are known
/// to lean with the match by less than kSupportingLean, any lean of GNSS to the other side
/// suffices.
constexpr double kOpposingLean = 1.5;
constexpr double kSupportingLean = 1.0;
/// The wheels lean until WheelDifference has learned a bias, so the part of their lean that is
/// known decays with this time constant.
constexpr double kWheelMemory_s = 30.0;
/// Larger innovations count as this many standard deviations, so that one outlier is no drift.
constexpr double kMaxDriftStep = 3.0;
/// Limit for the change of GNSS errors, in standard deviations of the change. The other number is
/// added to it, in standard deviations of GNSS: the expected change of two close times is almost 0.
constexpr double kGnssMoveLimit = 5.0;
constexpr double kGnssMoveLeast = 0.3;
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

/// The part of the innovation that a match supports. It is small along an axis where the match sees
/// little.
Eigen::Vector3d supported_offset(const PoseInnovation& innovation) {
  const Eigen::Matrix3d plausible = kPlausibleOffset.cwiseAbs2().asDiagonal();
  return plausible * (plausible + innovation.covariance).ldlt().solve(innovation.error);
}

/// The axis with the largest absolute value.
size_t largest_of(const Eigen::Vector3d& values) {
  Eigen::Index axis = 0;
  values.cwiseAbs().maxCoeff(&axis);
  return static_cast<size_t>(axis);
}

}  // namespace

bool Arbiter::Voter::jumps(Time time, const PoseInnovation& innovation) const {
  if (!last_passed) return false;
  const double elapsed_s = std::abs(to_seconds(time - *last_passed));
  const double reach_m =
      kOdometryError_mps * elapsed_s + 0.5 * kOdometryError_mps2 * square_of(elapsed_s);
  const double reach_rad =
      kOdometryError_radps * elapsed_s + 0.5 * kOdometryError_radps2 * square_of(elapsed_s);
  const Eigen::Vector3d reach(reach_m, reach_m, reach_rad);
  const Eigen::Vector3d noise = 4.0 * innovation.covariance.diagonal().cwiseSqrt();
  const Eigen::Vector3d jump = (innovation.error - last_passed_error).cwiseAbs();
  return ((jump - noise - reach).array() > 0.0).any();
}

void Arbiter::Voter::add(Time time, const PoseInnovation& innovation, bool passes_gate) {
  const Eigen::Vector3d sigma = innovation.covariance.diagonal().cwiseSqrt();
  far_off = !passes_gate && innovation.unexplained > kFarOff;
  const Eigen::Vector3d in_sigmas =
      innovation.error.cwiseQuotient(sigma).cwiseMax(-kMaxDriftStep).cwiseMin(kMaxDriftStep);
  // A measurement that does not see an axis says nothing about the drift along it.
  const Eigen::Array<bool, 3, 1> seen = sigma.array() <= kPlausibleOffset.array();
  if (!innovation.repeats) {
    drift.array() += kDriftGain * seen.cast<double>() * (in_sigmas - drift).array();
  }
  if (passes_gate) {
    last_passed = time;
    last_passed_error = innovation.error;
    refused_in_a_row = 0;
    for (size_t axis = 0; axis < seen_at.size(); ++axis) {
      if (seen(static_cast<Eigen::Index>(axis))) seen_at[axis] = time;
    }
  } else {
    if (refused_in_a_row++ == 0) jumped = jumps(time, innovation);
    offset = supported_offset(innovation);
    refused_axis = largest_of(innovation.error.cwiseQuotient(sigma));
  }
  agreed_in_a_row = innovation.squared_distance <= kAgrees ? agreed_in_a_row + 1 : 0;
}

Eigen::Vector3d Arbiter::Voter::lean() const {
  if (excluded) return Eigen::Vector3d::Zero();
  static const double sigma = std::sqrt(kDriftGain / (2.0 - kDriftGain));
  return drift / sigma;
}

bool Arbiter::Voter::drifts() const {
  return lean().cwiseAbs().maxCoeff() > kDriftLimit;
}

void Arbiter::Voter::exclude() {
  if (excluded) return;
  excluded = true;
  agreed_in_a_row = 0;
}

bool Arbiter::Voter::readmit_after(int agreeing) {
  if (!excluded || agreed_in_a_row < agreeing) return false;
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
  const auto agree_on = [&leans](double side, int voters, double least_lean) {
    int leaning = 0;
    double sum = 0.0;
    for (const double lean : leans) {
      if (side * lean <= least_lean) continue;
      ++leaning;
      sum += side * lean;
    }
    return leaning >= voters && sum > kSharedLimit * std::sqrt(leaning);
  };
  return agree_on(-1.0, 2, kSharedLean) || agree_on(1.0, 2, kSharedLean) ||
         agree_on(-1.0, 3, kLeanOfThree) || agree_on(1.0, 3, kLeanOfThree);
}

/// Whether the heading of the match drifts, and dead reckoning is nearer to the heading of GNSS.
bool Arbiter::match_turns_alone() const {
  const double match = std::abs(match_.lean().z());
  return match > kDriftLimit && match > std::abs(gnss_.lean().z()) && match_leans_alone();
}

void Arbiter::forget_drift(Time now) {
  if (wheel_lean_ && std::abs(*wheel_lean_) > kSharedLean) {
    known_wheel_lean_ = *wheel_lean_ + known_wheel_lean_at(now);
    wheel_lean_known_at_ = now;
  }
  wheel_lean_.reset();
  match_.drift.setZero();
  gnss_.drift.setZero();
}

void Arbiter::add_odometry(Time time, const std::optional<double>& wheel_lean) {
  wheel_lean_ = wheel_lean;
  if (wheel_lean_) *wheel_lean_ -= known_wheel_lean_at(time);
}

double Arbiter::known_wheel_lean_at(Time time) const {
  return known_wheel_lean_ * std::exp(-to_seconds(time - wheel_lean_known_at_) / kWheelMemory_s);
}

void Arbiter::add_match(Time time, const PoseInnovation& innovation, bool passes_gate) {
  if (passes_gate && !answers_dispute(innovation)) return;
  const bool begins = !passes_gate && match_.refused_in_a_row == 0;
  match_.add(time, innovation, passes_gate);
  if (passes_gate) explained_ = false;
  if (begins) {
    dispute_since_ = time;
    for (GnssRecord& record : gnss_records_) record.match_offset = match_.offset;
  }
  match_.readmit_after(kMatchesToReadmit);
}

/// Whether the match sees the disputed axis well enough to end the dispute. A match that sees
/// nothing along this axis leaves the dispute open.
bool Arbiter::answers_dispute(const PoseInnovation& innovation) const {
  return match_.refused_in_a_row == 0 ||
         squared_distance(match_.offset, innovation.covariance) >= kTelling;
}

void Arbiter::add_gnss(Time time, const PoseInnovation& innovation, bool passes_gate,
                       const std::optional<GnssError>& gnss_error) {
  gnss_.add(time, innovation, passes_gate);
  gnss_added_ = time;
  gnss_records_[gnss_count_++ % kGnssRecords] = {.time = time,
                                                 .error = innovation.error,
                                                 .covariance = innovation.covariance,
                                                 .from_estimate = innovation.squared_distance,
                                                 .match_offset = match_.offset};
  if (!gnss_error) {
    forget_gnss_errors();
  } else if (!gnss_.excluded) {
    note_gnss_error(time, *gnss_error);
  }
  if (gnss_.readmit_after(kGnssToReadmit)) forget_gnss_errors();
}

void Arbiter::forget_gnss_errors() {
  gnss_error_count_ = 0;
  moved_gnss_axis_.reset();
  gnss_.drift.setZero();
}

void Arbiter::note_gnss_error(Time time, const GnssError& gnss_error) {
  if (time < next_gnss_error_) return;
  next_gnss_error_ = time + std::chrono::seconds(1);
  moved_gnss_axis_.reset();
  const size_t known = std::min(gnss_error_count_, kGnssErrors);
  for (size_t i = 0; i < known; ++i) {
    const TimedGnssError& before = gnss_errors_[i];
    const double age_s = to_seconds(time - before.time);
    const double expected = std::sqrt(2.0 * (1.0 - std::exp(-age_s / gnss_correlation_s_)));
    const Eigen::Vector3d change =
        GnssError{gnss_error.in_map - before.in_map, gnss_error.vehicle_yaw_rad}.in_vehicle();
    if (change.cwiseAbs().maxCoeff() > kGnssMoveLimit * expected + kGnssMoveLeast) {
      moved_gnss_axis_ = largest_of(change);
    }
  }
  gnss_errors_[gnss_error_count_++ % kGnssErrors] = {time, gnss_error.in_map};
}

bool Arbiter::match_agrees(Time now) const {
  return match_.refused_in_a_row == 0 && match_.last_passed &&
         now - *match_.last_passed <= kMatchLifetime && !match_.excluded;
}

bool Arbiter::match_sees(size_t axis, Time now) const {
  const auto& seen_at = match_.seen_at[axis];
  return match_agrees(now) && seen_at && now - *seen_at <= kMatchLifetime;
}

/// Returns whether the refused GNSS samples are wrong. For this, the match must agree with the
/// filter. Either GNSS must also have jumped, or the match must see the axis along which GNSS
/// is off.
bool Arbiter::gnss_refusals_are_denied(Time now) const {
  return match_agrees(now) && (gnss_.jumped || match_sees(gnss_.refused_axis, now));
}

/// Whether the match sees the axis on which GNSS drifts, and does not lean to the same side.
bool Arbiter::match_denies_drift(size_t axis, Time now) const {
  const auto i = static_cast<Eigen::Index>(axis);
  const double with_gnss = std::copysign(1.0, gnss_.lean()(i)) * match_.lean()(i);
  return match_sees(axis, now) && with_gnss < kSupportingLean;
}

bool Arbiter::gnss_moved(Time now) const {
  return (gnss_is_refused() && gnss_refusals_are_denied(now)) ||
         (gnss_.drifts() && match_denies_drift(largest_of(gnss_.lean()), now)) ||
         (moved_gnss_axis_ && match_sees(*moved_gnss_axis_, now));
}

Verdict Arbiter::judge(Time now, PoseStanding standing) {
  Verdict verdict;
  const bool valid = standing == PoseStanding::kValid;
  if (!valid) gnss_.excluded = false;
  // While GNSS is silent, its refusals are no dispute. After it, its error may be another one.
  if (!gnss_speaks(now)) gnss_.refused_in_a_row = 0;
  // Once the pose is lost, the place of the refused match says nothing any more. A right match that
  // is compared with this place would not count, and would never be trusted again.
  if (!valid && match_.excluded) match_.refused_in_a_row = 0;
  if (match_is_disputed() && !match_.excluded) {
    decide_dispute(verdict, standing);
    if (verdict.odometry_contradicts) odometry_wrong_until_ = now + kOdometryMemory;
  }
  if (valid && match_turns_alone() && !gnss_.excluded) {
    exclude_match();
    match_.drift.setZero();
  }
  if (valid && gnss_moved(now) && !odometry_drifts()) gnss_.exclude();
  gnss_disputed_ = gnss_is_refused() && !gnss_.excluded && !match_is_disputed() &&
                   !gnss_refusals_are_denied(now);
  if (gnss_disputed_) verdict.undecided = true;
  if (odometry_wrong_until_ && now < *odometry_wrong_until_) verdict.odometry_contradicts = true;
  if (match_.excluded) verdict.match_contradicts = true;
  if (gnss_.excluded) verdict.gnss_contradicts = verdict.gnss_excluded = true;
  return verdict;
}

void Arbiter::exclude_match() {
  match_.exclude();
  explained_ = true;
}

void Arbiter::decide_dispute(Verdict& verdict, PoseStanding standing) {
  if (explained_) return;
  const bool harmless = (match_.offset.cwiseAbs().array() < kHarmlessOffset.array()).all();
  if (harmless && standing == PoseStanding::kValid) return;
  if (standing == PoseStanding::kNew) {
    verdict.undecided = true;
    return;
  }
  if (match_.jumped) {
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
    from_match += squared_distance(record.error - record.match_offset, record.covariance);
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
  if (match_is_disputed() && !match_.excluded) return match_.offset;
  if (gnss_disputed_ && !gnss_.jumped) return gnss_.offset;
  return std::nullopt;
}

}  // namespace bevloc
