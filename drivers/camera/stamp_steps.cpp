#include "drivers/camera/stamp_steps.h"

namespace bevloc::drivers {
namespace {

/// Stamp and arrival may differ by up to this, because a busy thread takes a frame late.
constexpr Duration kAgreement = std::chrono::milliseconds(20);
/// Only two frames that are at most this many periods apart are compared. Over more periods, small
/// errors of the period would add up.
constexpr uint64_t kMostFrames = 5;
/// A tolerated offset shrinks by 1/kForgetting with each frame.
constexpr int kForgetting = 16;

}  // namespace

bool StampSteps::add(Time stamp, Time arrival, uint64_t sequence) {
  const Seen frame{stamp, arrival, sequence};
  if (latest_) judge(frame);
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
  if (std::chrono::abs(jump) > (timely ? kAgreement : kTolerated)) offset_ += jump;
}

}  // namespace bevloc::drivers
