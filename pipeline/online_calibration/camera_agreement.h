// Finds the cameras that contradict the map, because their pictures show another road than those of
// the other cameras.
#pragma once

#include <array>

#include "common/cameras.h"
#include "pipeline/online_calibration/extrinsic_sums.h"

namespace bevloc {

/// Compares what each camera sees with the map, over some seconds of driving. A camera contradicts
/// the map if its agreement (ZNCC) is far below that of the median camera. This finds cameras whose
/// cables are swapped, and a camera that is turned far.
///
/// One thread. Does not allocate.
class CameraAgreement {
 public:
  /// Adds the sums of one match. Only the cameras in `used` are judged, and the others keep their
  /// verdict. If fewer than four cameras can be judged, all keep their verdict.
  void add(const std::array<SeenByCamera, kCameraCount>& seen, CameraMask used, double step_s);

  CameraMask contradicting() const { return contradicting_; }

 private:
  struct Seen {
    SeenByCamera sums;    ///< sums that fade over some seconds of driving
    double time_s = 0.0;  ///< driving time that the sums contain
    /// Time with too low a share. It counts less while the other camera of the same side is not
    /// known to agree well with the map.
    double contradicted_s = 0.0;
    double absent_s = 0.0;  ///< time since the camera was last used
  };

  /// Whether enough was seen to judge. If so, `shares` are relative to the median camera.
  bool shares_of(CameraMask judged, std::array<double, kCameraCount>& shares) const;

  std::array<Seen, kCameraCount> cameras_{};
  CameraMask contradicting_;
};

}  // namespace bevloc
