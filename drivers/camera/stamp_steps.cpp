#include "drivers/camera/stamp_steps.h"

#include <algorithm>

namespace bevloc::drivers {
namespace {

/// Two of stamp, arrival and sequence number agree if their times since the frame before differ by
/// at most this, because a busy thread may take a frame late.
constexpr Duration kAgreement = std::chrono::milliseconds(20);
/// Only two frames that are at most this many periods apart are compared. Over more periods, small
/// errors of the period would add up.
constexpr uint64_t kMostFrames = 5;
/// A tolerated offset shrinks by 1/kForgetting with each frame.
constexpr int kForgetting = 16;
/// The usual lag may grow by this much with each frame, because a camera can stay slower than
/// before.
constexpr Duration kLagGrowth = std::chrono::milliseconds(1);
/// A jump counts for good when this many frames have not disproved it.
constexpr int kDoubtedFrames = 50;

}  // namespace

bool StampSteps::add(Time stamp, Time arrival, uint64_t sequence) {
  const Seen frame{stamp, arrival, sequence};
  if (latest_) judge(frame);
  add_lag(arrival - stamp);
  count_jump();
  latest_ = frame;
  return std::chrono::abs(offset_) > kTolerated;
}

void StampSteps::judge(const Seen& frame) {
  if (frame.sequence <= latest_->sequence) return;
  const uint64_t frames = frame.sequence - latest_->sequence;
  if (frames > kMostFrames) return;
  const Duration stamped = frame.stamp - latest_->stamp;
  const Duration arrived = frame.arrival - latest_->arrival;
  const auto count = static_cast<Duration::rep>(frames);
  if (std::chrono::abs(stamped - arrived) <= kAgreement) {
    period_ = stamped / count;
    // A tolerated offset shrinks, so that small errors of single stamps do not add up.
    if (std::chrono::abs(offset_) <= kTolerated) offset_ -= offset_ / kForgetting;
    return;
  }
  if (!period_) return;
  const Duration expected = *period_ * count;
  const Duration jump = stamped - expected;
  const bool timely = std::chrono::abs(arrived - expected) <= kAgreement;
  // A large jump counts although the frame arrived late, because what makes a stamp jump often
  // delays the frame, too.
  if (std::chrono::abs(jump) > (timely ? kAgreement : kTolerated)) add_jump(jump);
}

/// Adds a jump to the offset. While an earlier jump is in doubt, the usual lag from before that
/// jump stays the reference, because later lags belong to an offset that is not certain.
void StampSteps::add_jump(Duration jump) {
  if (!doubt_ && std::chrono::abs(jump) <= kTolerated) {
    offset_ += jump;
    return;
  }
  if (!doubt_) doubt_ = Doubt{.usual_lag = usual_lag_, .offset_before = offset_};
  doubt_->offset_after = offset_ + jump;
  doubt_->least_lag = Duration::max();
  doubt_->frames = 0;
}

void StampSteps::add_lag(Duration lag) {
  if (!doubt_) {
    usual_lag_ = latest_ ? std::min(lag, usual_lag_ + kLagGrowth) : lag;
    return;
  }
  doubt_->least_lag = std::min(doubt_->least_lag, lag);
  offset_ = doubt_->is_disproved() ? doubt_->offset_before : doubt_->offset_after;
  if (++doubt_->frames < kDoubtedFrames) return;
  usual_lag_ = doubt_->least_lag;
  doubt_.reset();
}

void StampSteps::count_jump() {
  if (std::chrono::abs(offset_ - counted_offset_) <= kTolerated) return;
  ++jumps_;
  counted_offset_ = offset_;
}

void StampSteps::reset() {
  const uint64_t jumps = jumps_;
  *this = StampSteps();
  jumps_ = jumps;
}

bool StampSteps::Doubt::is_disproved() const {
  const Duration jump = offset_after - offset_before;
  // After a jump to later stamps, a frame has the usual lag only if it is late by the whole jump.
  if (jump > Duration::zero()) return std::chrono::abs(least_lag - usual_lag) <= kAgreement;
  // After a jump to earlier stamps, each frame lags by the whole jump.
  return least_lag < usual_lag - jump - kAgreement;
}

}  // namespace bevloc::drivers
