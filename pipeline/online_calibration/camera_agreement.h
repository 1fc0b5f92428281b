// Which cameras contradict the map: their pictures show another road than the other cameras.
#pragma once

#include <array>

#include "common/cameras.h"
#include "pipeline/online_calibration/extrinsic_sums.h"

namespace bevloc {

/// Compares what each camera sees with the map, over some seconds of driving. A camera contradicts
/// the map if its agreement (ZNCC) is far below that of the median camera. This finds cameras whose
/// cables are swapped, and a camera that is turned far.
///
/// One thread, no allocation.
class CameraAgreement {
 public:
  /// Adds the sums of one match. Only the cameras in `used` are judged: the others keep their
  /// verdict, and if fewer than four are used, all do.
  void add(const std::array<SeenByCamera, kCameraCount>& seen, CameraMask used, double step_s);

  CameraMask contradicting() const { return contradicting_; }

 private:
  struct Seen {
    SeenByCamera sums;            ///< fade over some seconds of driving
    double time_s = 0.0;          ///< driving time in them
    double contradicted_s = 0.0;  ///< judged for so long, each time as contradicting
    double absent_s = 0.0;        ///< not used for so long
  };

  /// Whether enough was seen to judge. If so, `shares` are relative to the median camera.
  bool shares_of(CameraMask judged, std::array<double, kCameraCount>& shares) const;

  std::array<Seen, kCameraCount> cameras_{};
  CameraMask contradicting_;
};

}  // namespace bevloc
