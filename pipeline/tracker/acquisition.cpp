#include "pipeline/tracker/acquisition.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace bevloc {

Acquisition::Acquisition(const AcquisitionParameters& parameters)
    : parameters_(parameters), recent_(parameters.needed) {
  assert(parameters.needed > 0);
}

bool Acquisition::add(Time time, const Se2& correction) {
  const double gap_s = to_seconds(time - last_time_);
  if (count_ > 0 && (gap_s <= 0.0 || gap_s > parameters_.max_gap_s)) reset();
  last_time_ = time;
  for (size_t i = 0; i < count_; ++i) {
    const size_t slot = (next_ + recent_.size() - 1 - i) % recent_.size();
    if (!agree(recent_[slot], correction)) {
      count_ = i;  // those before the disagreement no longer count
      break;
    }
  }
  recent_[next_] = correction;
  next_ = (next_ + 1) % recent_.size();
  count_ = std::min(count_ + 1, recent_.size());
  return count_ == recent_.size();
}

bool Acquisition::agree(const Se2& a, const Se2& b) const {
  const Se2 difference = correction_between(a, b);
  return std::abs(difference.x_m) <= parameters_.position_tolerance_m &&
         std::abs(difference.y_m) <= parameters_.position_tolerance_m &&
         std::abs(difference.yaw_rad) <= parameters_.yaw_tolerance_rad;
}

}  // namespace bevloc
