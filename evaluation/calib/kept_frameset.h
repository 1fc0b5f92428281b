// Keeps the frameset of a drive that shows most paint, for a picture.
#pragma once

#include "pipeline/calibration/refine/paint_lines.h"
#include "pipeline/calibration/refine/picture_recording.h"

namespace bevloc::evaluation {

/// Passes the pictures of a recording on. The recording and the map must outlive this object.
class KeepingRecording final : public PictureRecording {
 public:
  KeepingRecording(PictureRecording& recording, const MapIndex& map)
      : recording_(recording), map_(map) {}

  const ReferenceTrajectory& reference() const override { return recording_.reference(); }
  int framesets() const override { return recording_.framesets(); }
  void rewind() override { recording_.rewind(); }
  Status next(std::vector<RecordedPicture>& pictures) override {
    Status read = recording_.next(pictures);
    if (!read || pictures.empty()) return read;
    const auto pose = reference().at(pictures.front().time);
    if (!pose) return read;
    find_paint_points(map_, *pose, kNear_m, points_);
    if (points_.size() > most_) {
      most_ = points_.size();
      kept_ = pictures;
    }
    return read;
  }

  /// The pictures of the frameset with the longest paint nearby; empty if none was read.
  const std::vector<RecordedPicture>& kept() const { return kept_; }

 private:
  static constexpr double kNear_m = 15.0;

  PictureRecording& recording_;
  const MapIndex& map_;
  std::vector<PaintPoint> points_;
  size_t most_ = 0;
  std::vector<RecordedPicture> kept_;
};

}  // namespace bevloc::evaluation
