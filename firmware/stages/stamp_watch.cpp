#include "firmware/stages/stamp_watch.h"

#include <algorithm>

namespace bevloc::firmware {
namespace {

constexpr int kYaw = 2;
/// Headings with a smaller share of evidence are not compared with the yaw rate.
constexpr double kLeastYawEvidence = 0.8;

}  // namespace

void StampWatch::add_report(const VisionReport& report) {
  note_jump(report);
  compare_heading(report);
}

/// After a jump, what was learned about the earlier stamps no longer holds. Only a contradiction
/// stays known.
void StampWatch::note_jump(const VisionReport& report) {
  const bool is_first = report.stamps_jumped && !latest_jumped_;
  const bool is_further = report.stamps_jumped && report.stamp_jumps > jumps_;
  if (is_first) wrong_before_ = contradicts();
  if (is_first || is_further) {
    monitor_.note_gap();
    jumped_ = true;
  }
  if (!report.stamps_jumped && latest_jumped_) note_jump_back();
  latest_jumped_ = report.stamps_jumped;
  jumps_ = std::max(jumps_, report.stamp_jumps);
  if (!monitor_.agrees()) return;
  jumped_ = false;
  wrong_before_ = latest_jumped_;
}

/// The stamps are again as they were before the jump.
void StampWatch::note_jump_back() {
  if (wrong_before_) {
    monitor_.note_gap();
  } else {
    monitor_.reset();
  }
  jumped_ = wrong_before_;
}

void StampWatch::compare_heading(const VisionReport& report) {
  if (!report.had_prior || report.match.evidence != Evidence::kGood ||
      report.match.evidence_share(kYaw) < kLeastYawEvidence) {
    return;
  }
  monitor_.add_heading(report.frame_time, (report.prior * report.match.correction).yaw_rad);
}

void StampWatch::note_gap() {
  monitor_.note_gap();
  // Nothing changes after a jump back, or after a jump that bends overruled.
  if (!latest_jumped_ || !jumped_) return;
  // The next report says whether the stamps are still off.
  latest_jumped_ = jumped_ = false;
}

}  // namespace bevloc::firmware
