#include "firmware/stages/stamp_watch.h"

namespace bevloc::firmware {
namespace {

constexpr int kYaw = 2;
/// Headings with a smaller share of evidence are not compared with the yaw rate.
constexpr double kLeastYawEvidence = 0.8;

}  // namespace

void StampWatch::add_report(const VisionReport& report) {
  note_jump(report.stamps_jumped);
  compare_heading(report);
}

/// After a jump, what was learned about the earlier stamps no longer holds.
void StampWatch::note_jump(bool jumped) {
  if (jumped != latest_jumped_) monitor_.reset();
  jumped_ = jumped && (jumped_ || !latest_jumped_);
  latest_jumped_ = jumped;
  if (monitor_.agrees()) jumped_ = false;
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
  latest_jumped_ = jumped_ = false;
}

}  // namespace bevloc::firmware
