// When the fault of a run is present.
#pragma once

namespace bevloc::evaluation {

/// Seconds of the drive.
struct FaultTime {
  double from_s = 0.0;
  double until_s = 0.0;  ///< may lie beyond the end of the drive
};

}  // namespace bevloc::evaluation
