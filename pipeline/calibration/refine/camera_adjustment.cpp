#include "pipeline/calibration/refine/camera_adjustment.h"

namespace bevloc {

CameraModel adjusted(const CameraModel& camera, const CameraAdjustment& by) {
  CameraModel result = camera;
  result.vehicle_from_camera.rotation *= rotation_by(by.head<3>());
  result.vehicle_from_camera.translation_m += by.segment<3>(kForward);
  result.intrinsics.fx_px *= 1.0 + by[kFocal];
  result.intrinsics.fy_px *= 1.0 + by[kFocal];
  return result;
}

}  // namespace bevloc
