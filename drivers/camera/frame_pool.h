// A fixed number of pictures that a camera lends out and gets back.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/image.h"

namespace bevloc::drivers {

class FramePool;

/// A picture on loan. Dropping it gives it back to its pool, from any thread, also after the camera
/// that filled it has stopped or is gone. Empty when default-constructed or moved from.
class FrameBuffer {
 public:
  FrameBuffer() = default;
  FrameBuffer(FrameBuffer&& other) noexcept;
  FrameBuffer& operator=(FrameBuffer&& other) noexcept;
  FrameBuffer(const FrameBuffer&) = delete;
  FrameBuffer& operator=(const FrameBuffer&) = delete;
  ~FrameBuffer() { give_back(); }

  explicit operator bool() const { return pool_ != nullptr; }
  /// Of a buffer that is not empty.
  RgbImage& image();
  RgbView view() const;

 private:
  friend class FramePool;
  FrameBuffer(std::shared_ptr<FramePool> pool, int slot) : pool_(std::move(pool)), slot_(slot) {}
  void give_back();

  std::shared_ptr<FramePool> pool_;
  int slot_ = 0;
};

/// All memory is made by create(); borrowing and giving back neither allocate nor lock. Thread
/// safe.
class FramePool : public std::enable_shared_from_this<FramePool> {
 public:
  static constexpr int kMaxBuffers = 64;

  /// 1 to kMaxBuffers pictures.
  static std::shared_ptr<FramePool> create(int buffers, int width_px, int height_px);

  /// A picture with old pixels in it; empty when all are lent out.
  FrameBuffer borrow();

  int buffers() const { return static_cast<int>(images_.size()); }
  int lent() const;

 private:
  friend class FrameBuffer;
  FramePool(int buffers, int width_px, int height_px);

  std::vector<RgbImage> images_;
  std::atomic<uint64_t> free_;  ///< bit i: picture i is here
};

}  // namespace bevloc::drivers
