// Whether corrections can be trusted before the pose is tracked.
#pragma once

#include <vector>

#include "common/se2.h"
#include "common/time.h"

namespace bevloc {

struct AcquisitionParameters {
  int needed = 4;                     ///< corrections in a row that agree
  double position_tolerance_m = 0.4;  ///< between any two of them, along each axis
  double yaw_tolerance_rad = radians(0.7);
  double max_gap_s = 0.5;  ///< between one and the next
};

/// One match can be wrong with confidence; several in a row, from different places, seldom agree on
/// the same wrong answer. Counts corrections of one prior that is itself NOT corrected meanwhile:
/// the prior drifts slowly, so right answers are alike.
class Acquisition {
 public:
  explicit Acquisition(const AcquisitionParameters& parameters = {});

  /// Adds the correction of the frame taken at `time`. True once the last ones all agree.
  bool add(Time time, const Se2& correction);

  void reset() { count_ = 0; }

 private:
  bool agree(const Se2& a, const Se2& b) const;

  AcquisitionParameters parameters_;
  std::vector<Se2> recent_;  ///< the last `count_` corrections, a ring
  size_t next_ = 0;
  size_t count_ = 0;
  Time last_time_;
};

}  // namespace bevloc
