// Keeps drawn pictures, so that several simulated drives that see the same need not draw them
// again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <unordered_map>

#include "common/image.h"

namespace bevloc::drivers {

/// Thread-safe. Pictures are kept without loss, so a drive with a cache gives the same frames as
/// one without. When the memory is used up, further pictures are not kept. It would not help to
/// drop the oldest ones: each drive needs the pictures in the same order, so it would always need
/// one that was just dropped.
class PictureCache {
 public:
  /// Room for one drive of 60 s at 10 Hz with six cameras of 640 x 360 pixels (2.5 GB).
  static constexpr size_t kDefaultBytes = size_t{3} << 30U;

  explicit PictureCache(size_t max_bytes = kDefaultBytes) : max_bytes_(max_bytes) {}

  /// Copies the picture of this key into `image`, which must have its size. Returns false if there
  /// is none. A key must depend on all that the picture depends on.
  bool find(uint64_t key, RgbImage& image);

  /// Keeps a copy of the picture if there is room.
  void keep(uint64_t key, const RgbImage& image);

  /// Forgets all pictures. Use it between drives that see different worlds.
  void clear();

  struct Counters {
    uint64_t found = 0;
    uint64_t kept = 0;
    size_t bytes = 0;  ///< size of the pictures that are kept now
  };
  Counters counters() const;

 private:
  const size_t max_bytes_;
  mutable std::mutex mutex_;
  std::unordered_map<uint64_t, Pixels> pictures_;  // guarded by mutex_
  Counters counters_;                              // guarded by mutex_
};

}  // namespace bevloc::drivers
