// Hands copies of localizations from the vision thread to the thread that draws the live page.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <vector>

#include "common/image_planes.h"
#include "firmware/stages/vision_stage.h"
#include "pipeline/calibration/rig.h"

namespace bevloc::firmware {

/// A copy of one localization with the image of one camera.
struct LiveSample {
  Time frame_time{};
  CameraMask present;
  int camera = 0;  ///< the camera of the image
  bool has_image = false;
  ImageView image;  ///< its planes lie in `bytes`
  Pixels bytes;
  Se2 prior;
  /// The vehicle's pose at the exposure of the image, in the vehicle frame at the prior.
  Se2 reference_from_exposure;
  MatchResult match;
  HypothesisGrid hypotheses;
  std::array<std::vector<float>, 3> probabilities;  ///< along x, y and yaw
  bool has_mask = false;
  std::vector<float> mask;  ///< logits, [3, 400, 200]
};

/// Holds one sample. The vision thread copies a localization into it only while somebody looks, the
/// sample is free and the previous copy is old enough. It copies the image of one camera at a time,
/// so that no frameset takes the time for six. The vision thread never waits and allocates nothing.
///
/// Thread-bound: offer() is called from the vision thread, take() from the drawing thread.
/// set_viewers() is thread-safe.
class LiveFeed {
 public:
  static constexpr Duration kPicturePeriod = std::chrono::milliseconds(95);
  static constexpr Duration kMaskPeriod = std::chrono::milliseconds(950);

  /// Makes room for the images of `rig` and for `hypotheses` per axis. A larger image is not
  /// copied.
  LiveFeed(const Rig& rig, int hypotheses);

  void offer(const VisionSnapshot& snapshot);

  /// Calls `draw` with the copy, if there is a new one. Returns whether there was.
  bool take(const std::function<void(const LiveSample&)>& draw);

  /// When the first viewer comes, discards a copy that was made for earlier viewers.
  void set_viewers(int viewers);

 private:
  enum class State : uint8_t { kFree, kWriting, kFull, kReading };

  void copy(const VisionSnapshot& snapshot);
  void copy_image(const ImageView& image);
  bool copy_plane(const ImagePlane& from, const PlaneSize& size, size_t& used, ImagePlane& to);

  std::atomic<int> viewers_{0};
  std::atomic<State> state_{State::kFree};
  LiveSample sample_;
  int next_camera_ = 0;
  Time latest_{};  ///< time of the latest copy
  Time latest_mask_{};
};

}  // namespace bevloc::firmware
