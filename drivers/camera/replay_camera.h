// A camera that plays recorded pictures.
#pragma once

#include <filesystem>
#include <vector>

#include "drivers/camera/paced_camera.h"

namespace bevloc::drivers {

struct ReplayCameraConfig {
  int camera = 0;  ///< index into kCameraNames
  /// Holds PNG or JPEG files and `frames.txt`: a line `sequence time_ns file` for each picture,
  /// sequence and time growing, # before a comment.
  std::filesystem::path directory;
  int width_px = 0;
  int height_px = 0;
  /// Added to every recorded time: the same for all cameras of a recording.
  Duration shift{0};
  Duration exposure{0};
  Duration readout{0};  ///< from start of exposure to arrival
  int buffers = 4;
};

/// One recorded picture.
struct RecordedFrame {
  uint64_t sequence = 0;
  Time time;
  std::filesystem::path file;
};

/// Reads `directory`/frames.txt and looks that each picture is there; an error names file and line.
Result<std::vector<RecordedFrame>> load_recording(const std::filesystem::path& directory);

/// start() reads the index: what is due from that moment on is played. A picture that cannot be
/// read, or has another size, fails next_frame(), which then goes on with the one after. Decoding
/// allocates: a replay is no appliance.
class ReplayCamera final : public PacedCamera {
 public:
  ReplayCamera(const ReplayCameraConfig& config, Clock& clock);

 private:
  Status open(Time now) override;
  std::optional<Delivery> next_delivery() override;
  Status draw(const Delivery& delivery, RgbImage& image) override;

  const ReplayCameraConfig config_;
  std::vector<RecordedFrame> recording_;
  size_t first_ = 0;  ///< of this start()
  size_t next_ = 0;
};

}  // namespace bevloc::drivers
