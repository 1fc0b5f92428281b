// The pictures of a simulated drive, in memory, of cameras whose true calibration is known.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "pipeline/calibration/refine/camera_adjustment.h"
#include "pipeline/calibration/refine/picture_recording.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/map/hd_map.h"

namespace bevloc::evaluation {

struct SimulatedRecordingOptions {
  uint64_t seed = 301;  ///< of town, drive and all errors
  double duration_s = 60.0;
  double interval_s = 0.5;
};

/// Draws all pictures when it is made, which takes a minute or so.
class SimulatedRecording final : public PictureRecording {
 public:
  explicit SimulatedRecording(const SimulatedRecordingOptions& options);

  const ReferenceTrajectory& reference() const override { return reference_; }
  int framesets() const override { return static_cast<int>(framesets_.size()); }
  void rewind() override { next_ = 0; }
  Status next(std::vector<RecordedPicture>& pictures) override;

  const HdMap& map() const { return map_; }
  /// The calibration with errors.
  const Rig& rig() const { return rig_; }
  /// What refine_rig() should find for each camera.
  const std::array<CameraAdjustment, kCameraCount>& truth() const { return truth_; }

 private:
  HdMap map_;
  Rig rig_;
  std::array<CameraAdjustment, kCameraCount> truth_;
  ReferenceTrajectory reference_{{}};
  std::vector<std::vector<RecordedPicture>> framesets_;
  size_t next_ = 0;
};

}  // namespace bevloc::evaluation
