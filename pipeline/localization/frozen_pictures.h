// Notices cameras whose picture stands still while the vehicle drives.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "pipeline/calibration/rig.h"

namespace bevloc {

/// Of one network image: every change within one of its 32-bit words changes it, and other changes
/// all but surely (each word is added to one of sixteen sums, which is rotated before).
using PictureChecksum = std::array<uint32_t, 16>;

/// `planes`: a multiple of 64 values.
PictureChecksum picture_checksum(std::span<const int8_t> planes);

/// A sensor that hangs, or a grabber that repeats its buffer, sends new frames with an old picture.
/// A real sensor never does: its noise and the vehicle's motion change something. Compared is the
/// network's input, which is the camera's picture box-filtered and quantized: all of its 92160
/// values stay the same only if the picture does, it is at hand whatever the camera's format, and
/// its checksum takes 13 us for six cameras. Allocates nothing. Not thread safe.
class FrozenPictures {
 public:
  /// Repetitions in a row, each seen while the vehicle drove, after which a picture is frozen.
  static constexpr int kRepetitions = 3;

  /// Notes the network's input of a new exposure of a camera and says whether its picture is
  /// frozen. A repetition counts only while `driving`; a frozen picture stays frozen until it
  /// changes, also while the vehicle stands.
  bool is_frozen(int camera, std::span<const int8_t> planes, bool driving);

 private:
  struct History {
    std::optional<PictureChecksum> latest;
    int repetitions = 0;
  };
  std::array<History, kCameraCount> histories_;
};

}  // namespace bevloc
