// A camera that plays recorded images.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "common/cameras.h"
#include "drivers/camera/paced_camera.h"

namespace bevloc::drivers {

/// The file in the folder of a camera that lists its images.
inline constexpr const char* kFrameIndex = "frames.txt";

struct ReplayCameraConfig {
  int camera = 0;  ///< index into kCameraNames
  /// The folder with PNG or JPEG files and the index kFrameIndex, which has one line `sequence
  /// time_ns file` per image. Sequence and time must increase. `#` starts a comment.
  std::filesystem::path directory;
  int width_px = 0;
  int height_px = 0;
  /// The time that is added to every recorded time. It must be the same for all cameras of a
  /// picture folder.
  Duration shift{0};
  Duration exposure{0};
  Duration readout{0};  ///< from start of exposure to arrival
  int buffers = kDefaultFrameBuffers;
};

/// One recorded frame.
struct RecordedFrame {
  uint64_t sequence = 0;
  Time time;
  std::filesystem::path file;
};

/// Reads `directory`/frames.txt and checks that each file exists. An error names file and line.
Result<std::vector<RecordedFrame>> load_recording(const std::filesystem::path& directory);

/// The frames of all cameras of a picture folder. A camera without a folder of its own has none.
using RecordedFrames = std::array<std::vector<RecordedFrame>, kCameraCount>;
Result<RecordedFrames> load_recordings(const std::filesystem::path& directory);

/// start() reads the index and plays the frames that are due from that moment on. next_frame()
/// fails for an image that cannot be read or has another size, and continues with the following one
/// in its next call. Decoding allocates memory, unlike other cameras.
class ReplayCamera final : public PacedCamera {
 public:
  ReplayCamera(const ReplayCameraConfig& config, Clock& clock);

 private:
  Status open(Time now) override;
  std::optional<Delivery> next_delivery() override;
  Status draw(const Delivery& delivery, RgbImage& image) override;

  const ReplayCameraConfig config_;
  std::vector<RecordedFrame> recording_;
  size_t first_ = 0;  ///< index of the first frame since start()
  size_t next_ = 0;
};

}  // namespace bevloc::drivers
