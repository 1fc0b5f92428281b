#include "firmware/stages/gnss_lag_watch.h"

namespace bevloc::firmware {

void GnssLagWatch::add_rate(Time time, double yaw_rate_radps) {
  monitor_.add_rate(time, yaw_rate_radps);
  if (!waiting_ || waiting_->time > time) return;
  monitor_.add_heading(waiting_->time, waiting_->yaw_rad);
  waiting_.reset();
}

void GnssLagWatch::add(const GnssSample& sample) {
  if (!sample.yaw || sample.yaw->sigma_rad > kMostSigma_rad) return;
  waiting_ = Heading{sample.time, sample.yaw->yaw_rad};
}

void GnssLagWatch::note_gap() {
  monitor_.note_gap();
  waiting_.reset();
}

void GnssLagWatch::reset() {
  monitor_.reset();
  waiting_.reset();
}

}  // namespace bevloc::firmware
