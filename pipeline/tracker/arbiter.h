// Decides which of the three voters is wrong: the match, GNSS or dead reckoning.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "common/time.h"
#include "pipeline/tracker/pose_update.h"

namespace bevloc {

/// Says which voters are wrong. The arbiter sets the first five fields. PoseEstimator sets
/// `map_contradicts`; it also sets `gnss_contradicts` while GNSS scatters (GnssScatter),
/// `undecided` when it starts again, and `odometry_contradicts` when the cause is that the wheels
/// slip. It clears `gnss_contradicts` and `gnss_excluded` while GNSS does not speak
/// (Arbiter::gnss_speaks()).
struct Verdict {
  bool match_contradicts = false;     ///< GNSS and dead reckoning agree, the match does not
  bool gnss_contradicts = false;      ///< match and dead reckoning agree, GNSS does not
  bool gnss_excluded = false;         ///< GNSS contradicts, and the filter does not use it
  bool odometry_contradicts = false;  ///< match and GNSS agree, dead reckoning does not
  bool undecided = false;             ///< two voters disagree, and the third does not decide
  bool map_contradicts = false;       ///< a constant offset to GNSS (MapOffsetMonitor)
};

/// How far the pose is trusted.
enum class PoseStanding : uint8_t {
  kNew,    ///< not valid since the filter started; a refused match does not say who is wrong
  kLost,   ///< the pose was valid, and is not now
  kValid,  ///< only in this state can GNSS be outvoted, because a lost pose needs GNSS
};

/// There are three voters: dead reckoning (the filter's prediction), the match, and GNSS. If the
/// gate refuses a match, it contradicts dead reckoning, and GNSS decides which of them is wrong. If
/// the gate refuses GNSS, the match decides. A wrong voter stays excluded until it has agreed with
/// the filter for a while, so a voter that only repeats a wrong place stays excluded.
///
/// Allocates nothing. One thread.
class Arbiter {
 public:
  /// `gnss_correlation_s` is the time constant of GNSS errors.
  explicit Arbiter(double gnss_correlation_s) : gnss_correlation_s_(gnss_correlation_s) {}

  /// A GNSS sample older than this says nothing about the pose.
  static constexpr Duration kGnssLifetime = std::chrono::seconds(2);

  /// Adds a match that reached the gate; `time` is its frame time.
  void add_match(Time time, const PoseInnovation& innovation, bool passes_gate);
  /// Adds a GNSS sample that reached the gate. `gnss_error` is Tracker::gnss_error(), or nothing
  /// while the pose is not valid and the error therefore not known.
  void add_gnss(Time time, const PoseInnovation& innovation, bool passes_gate,
                const std::optional<GnssError>& gnss_error);

  /// `wheel_lean` is OdometrySample::wheel_lean of a plausible sample.
  void add_odometry(Time time, const std::optional<double>& wheel_lean);

  /// Judges the voters. Call it after the measurements of one cycle.
  Verdict judge(Time now, PoseStanding standing);

  /// Whether the filter may use a measurement of this voter.
  bool trusts_match() const { return !match_.excluded; }
  bool trusts_gnss() const { return !gnss_.excluded; }

  /// Whether a GNSS sample of the last kGnssLifetime has reached the gate.
  bool gnss_speaks(Time now) const { return gnss_added_ && now - *gnss_added_ <= kGnssLifetime; }

  /// Whether dead reckoning drifts: the innovations of the match lean to one side, or at least two
  /// of match, GNSS and wheels say that the yaw rate has a bias. Returns false if only the heading
  /// of the match is wrong (match_leans_alone()).
  bool odometry_drifts() const;
  void forget_drift(Time now);

  int matches_refused_in_a_row() const { return match_.refused_in_a_row; }
  int gnss_refused_in_a_row() const { return gnss_.refused_in_a_row; }

  /// The offset of a disputed voter from the estimate, in the vehicle frame (m, m, rad). The pose
  /// may be wrong by as much. Returns an offset while a match is disputed and not excluded, or
  /// while GNSS is refused without a jump and the match cannot tell whether GNSS is right.
  /// Otherwise it returns nothing.
  std::optional<Eigen::Vector3d> open_dispute() const;

  /// Forgets everything, after the filter has started again.
  void reset() { *this = Arbiter(gnss_correlation_s_); }

 private:
  /// The record of one voter.
  struct Voter {
    int refused_in_a_row = 0;
    int agreed_in_a_row = 0;
    std::optional<Time> last_passed;
    Eigen::Vector3d last_passed_error = Eigen::Vector3d::Zero();
    bool excluded = false;
    bool far_off = false;  ///< the latest innovation is larger than any scatter
    /// Moving average of the innovations in their standard deviations, per axis. It is near zero
    /// unless the voter drifts against the filter.
    Eigen::Vector3d drift = Eigen::Vector3d::Zero();

    void add(Time time, const PoseInnovation& innovation, bool passes_gate);
    bool jumped = false;  ///< the refusals began with a jump that no vehicle can make
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< offset of the latest refused measurement
    size_t refused_axis = 0;  ///< axis on which it is farthest off in standard deviations
    /// The latest time at which a measurement that passed saw the axis well enough to judge another
    /// voter.
    std::array<std::optional<Time>, 3> seen_at;

    /// Whether `innovation` differs from the last one that passed by more than undetected errors of
    /// odometry explain. OdometryMonitor does not detect an error that looks like a possible
    /// motion.
    bool jumps(Time time, const PoseInnovation& innovation) const;
    /// `drift` in its own standard deviations.
    Eigen::Vector3d lean() const;
    bool drifts() const;
    /// Does nothing if the voter is excluded already.
    void exclude();
    /// Ends the exclusion after so many agreeing measurements in a row. Returns whether it ended.
    bool readmit_after(int agreeing);
  };

  /// The innovation of a recent GNSS sample.
  struct GnssRecord {
    Time time;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    double from_estimate = 0.0;  ///< squared distance
    /// Offset of the match that was disputed when the sample came. The first match of a dispute
    /// sets it for the samples that came between its frame and the match itself.
    Eigen::Vector3d match_offset = Eigen::Vector3d::Zero();
  };

  static constexpr int kDisputingRefusals = 3;
  /// GNSS is excluded after this many refused samples in a row, if the match agrees.
  static constexpr int kGnssRefusals = 5;

  bool match_is_disputed() const {
    return match_.refused_in_a_row >= kDisputingRefusals || match_.far_off;
  }
  bool match_agrees(Time now) const;
  bool match_sees(size_t axis, Time now) const;
  bool match_turns_alone() const;
  bool gnss_is_refused() const { return gnss_.refused_in_a_row >= kGnssRefusals; }
  bool gnss_refusals_are_denied(Time now) const;
  bool match_denies_drift(size_t axis, Time now) const;
  bool gnss_moved(Time now) const;
  bool answers_dispute(const PoseInnovation& innovation) const;
  /// Returns `lean`, positive if the match's heading leans to the same side, otherwise negative.
  double with_match(double lean) const;
  /// Whether GNSS leans to the other side than the match in heading: clearly, or by less if the
  /// wheels do not lean with the match.
  bool match_leans_alone() const;
  bool yaw_rate_drifts() const;
  /// The lean of a bias that the filter has taken into account already.
  double known_wheel_lean_at(Time time) const;
  /// Excludes the match. An open dispute of the match then has its verdict.
  void exclude_match();
  void decide_dispute(Verdict& verdict, PoseStanding standing);
  void ask_gnss(Verdict& verdict);
  void forget_gnss_errors();
  void note_gnss_error(Time time, const GnssError& gnss_error);

  static constexpr size_t kGnssRecords = 8;
  static constexpr size_t kGnssErrors = 20;

  double gnss_correlation_s_;
  Voter match_;
  Voter gnss_;
  std::optional<double> wheel_lean_;  ///< OdometrySample::wheel_lean minus what is known of it
  double known_wheel_lean_ = 0.0;     ///< value at `wheel_lean_known_at_`
  Time wheel_lean_known_at_{};
  Time dispute_since_;
  bool explained_ = false;      ///< the open dispute of the match has a verdict
  bool gnss_disputed_ = false;  ///< GNSS is refused, and nothing tells whether it is right
  std::array<GnssRecord, kGnssRecords> gnss_records_{};
  size_t gnss_count_ = 0;
  std::optional<Time> gnss_added_;  ///< time of the latest GNSS sample
  /// GNSS errors of the last seconds, one per second.
  struct TimedGnssError {
    Time time;
    Eigen::Vector3d in_map = Eigen::Vector3d::Zero();
  };
  std::array<TimedGnssError, kGnssErrors> gnss_errors_{};
  size_t gnss_error_count_ = 0;
  Time next_gnss_error_ = Time::min();
  std::optional<size_t> moved_gnss_axis_;
  std::optional<Time> odometry_wrong_until_;
};

}  // namespace bevloc
