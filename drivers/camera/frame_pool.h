// A pool of frame buffers, for cameras without hardware and for the recorder.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/image.h"
#include "drivers/camera/frame_buffer.h"

namespace bevloc::drivers {

/// create() allocates all memory. borrow() and the return of a buffer neither allocate nor lock.
/// borrow() lends the free buffer with the lowest number. So a buffer that is never lent takes up
/// no physical memory. Thread-safe.
class FramePool final : public FrameLender, public std::enable_shared_from_this<FramePool> {
 public:
  static constexpr int kMaxBuffers = 64;

  /// Makes a pool of 1 to kMaxBuffers buffers.
  static std::shared_ptr<FramePool> create(int buffers, int width_px, int height_px);

  /// Lends a buffer, whose pixels are undefined. Returns an empty buffer when all are lent.
  FrameBuffer borrow();

  /// Gives write access to a borrowed buffer, as long as no other thread reads it.
  RgbImage& image(const FrameBuffer& buffer) { return images_[buffer.slot()]; }

  int buffers() const { return static_cast<int>(images_.size()); }
  int lent() const;

 private:
  FramePool(int buffers, int width_px, int height_px);
  void give_back(int slot) noexcept override;

  std::vector<RgbImage> images_;
  std::atomic<uint64_t> free_;  ///< bit i is set if buffer i is not lent
};

}  // namespace bevloc::drivers
