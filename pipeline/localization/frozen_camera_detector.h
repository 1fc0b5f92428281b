// Detects frozen cameras: those that repeat images while the vehicle drives.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/cameras.h"

namespace bevloc {

/// Checksum of the network input of one camera. A change within a single 32-bit word always changes
/// the checksum; any other change does with near certainty. Each word is added to one of sixteen
/// sums after a rotation of that sum.
using ImageChecksum = std::array<uint32_t, 16>;

/// The size of `planes` must be a multiple of 64 values.
ImageChecksum image_checksum(std::span<const int8_t> planes);

/// A hanging sensor, a grabber that repeats its buffers, or a recording that is played in a loop
/// sends new frames with old images. A working sensor never repeats an image exactly, because of
/// its noise and the vehicle's motion.
///
/// Compares the network input, which is the box-filtered and quantised camera image: it has the
/// same layout for every camera format, and all its 92160 values repeat only if the image does. The
/// checksums of six cameras take 13 us. Allocates nothing. One thread.
class FrozenCameraDetector {
 public:
  /// A camera is frozen after this many consecutive repetitions while driving. An image that equals
  /// any of the camera's latest kRemembered different images is a repetition.
  static constexpr int kRepetitions = 3;
  /// Finds loops of up to 51 s at 10 images per second.
  static constexpr int kRemembered = 512;

  /// Adds the network input of a new frame of `camera` and returns whether the camera is frozen.
  /// Counts repetitions only while `driving`. A frozen camera stays frozen until its image changes,
  /// even if the vehicle stops.
  bool is_frozen(int camera, std::span<const int8_t> planes, bool driving);

 private:
  /// A checksum, mixed into one word. Two different images have the same digest with a probability
  /// of 2^-64.
  using Digest = uint64_t;

  struct History {
    /// Returns whether the image was remembered, and remembers it if not.
    bool knows(Digest image);

    std::array<Digest, kRemembered> images{};  ///< a ring; only the first `count` are in use
    int count = 0;
    int oldest = 0;  ///< index of the oldest image once the ring is full
    int repetitions = 0;
  };
  std::array<History, kCameraCount> histories_;
};

}  // namespace bevloc
