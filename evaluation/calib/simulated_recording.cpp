#include "evaluation/calib/simulated_recording.h"

#include <Eigen/Geometry>

#include "drivers/mock/mock_scene.h"
#include "drivers/mock/true_rig.h"
#include "evaluation/drive/reference_receiver.h"
#include "sim/random.h"
#include "sim/sim_rig.h"
#include "sim/world/world_generator.h"

namespace bevloc::evaluation {
namespace {

/// One sigma of the errors of the calibration that the refinement starts with.
constexpr drivers::CalibrationError kCalibrationSigma{
    .rotation_rad = 0.5 * kPerDegree, .translation_m = 0.05, .relative_focal = 0.005};
/// The offset of the time stamps of each camera, of either sign.
constexpr double kTimeStampOffset_s = 0.02;

/// The adjustment that turns `from` into `to`.
CameraAdjustment adjustment_between(const CameraModel& from, const CameraModel& to) {
  CameraAdjustment by = CameraAdjustment::Zero();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(from.vehicle_from_camera.rotation.transpose() *
                                               to.vehicle_from_camera.rotation));
  by.head<3>() = turn.angle() * turn.axis();
  by.segment<3>(kForward) =
      to.vehicle_from_camera.translation_m - from.vehicle_from_camera.translation_m;
  by[kFocal] = to.intrinsics.fx_px / from.intrinsics.fx_px - 1.0;
  return by;
}

}  // namespace

SimulatedRecording::SimulatedRecording(const SimulatedRecordingOptions& options)
    : rig_(sim::nominal_rig()) {
  constexpr double kSpare_s = 1.0;  // before and after, for time offsets
  const auto world = std::make_shared<const sim::World>(sim::generate_world(options.seed));
  const auto drive = std::make_shared<const sim::Drive>(
      *world, sim::seed_for(options.seed, "drive"), options.duration_s + 2.0 * kSpare_s);
  map_ = world->map;
  const Rig true_rig =
      drivers::true_rig(rig_, kCalibrationSigma, sim::seed_for(options.seed, "calibration"));
  sim::Random random(sim::seed_for(options.seed, "time offsets"));
  for (int c = 0; c < kCameraCount; ++c) {
    truth_[c] = adjustment_between(rig_.cameras[c], true_rig.cameras[c]);
    truth_[c][kTimeOffset] = (random.chance(0.5) ? 1.0 : -1.0) * kTimeStampOffset_s;
  }
  reference_ = receive_reference(*drive, sim::seed_for(options.seed, "reference"), Time{});
  drivers::MockScene scene(world, drive, {}, sim::seed_for(options.seed, "pixel noise"));
  RgbImage image;
  for (double time_s = kSpare_s; time_s < kSpare_s + options.duration_s;
       time_s += options.interval_s) {
    std::vector<RecordedPicture>& pictures = framesets_.emplace_back();
    for (int c = 0; c < kCameraCount; ++c) {
      scene.draw(c, true_rig.cameras[c], from_seconds(time_s), image);
      pictures.push_back(
          {c, Time{} + from_seconds(time_s - truth_[c][kTimeOffset]), grey_from(image.view())});
    }
  }
}

Status SimulatedRecording::next(std::vector<RecordedPicture>& pictures) {
  pictures.clear();
  if (next_ < framesets_.size()) pictures = framesets_[next_++];
  return {};
}

}  // namespace bevloc::evaluation
