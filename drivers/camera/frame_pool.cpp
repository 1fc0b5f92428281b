#include "drivers/camera/frame_pool.h"

#include <bit>
#include <cassert>

namespace bevloc::drivers {

std::shared_ptr<FramePool> FramePool::create(int buffers, int width_px, int height_px) {
  return std::shared_ptr<FramePool>(new FramePool(buffers, width_px, height_px));
}

FramePool::FramePool(int buffers, int width_px, int height_px)
    : free_(~uint64_t{0} >> (kMaxBuffers - buffers)) {
  assert(buffers >= 1 && buffers <= kMaxBuffers);
  images_.reserve(static_cast<size_t>(buffers));
  for (int i = 0; i < buffers; ++i) images_.push_back(RgbImage::uninitialized(width_px, height_px));
}

FrameBuffer FramePool::borrow() {
  uint64_t free = free_.load(std::memory_order_relaxed);
  while (free != 0) {
    const uint64_t without_lowest = free & (free - 1);
    if (free_.compare_exchange_weak(free, without_lowest, std::memory_order_acquire,
                                    std::memory_order_relaxed)) {
      const int slot = std::countr_zero(free);
      return {shared_from_this(), slot, images_[slot].view()};
    }
  }
  return {};
}

void FramePool::give_back(int slot) noexcept {
  // The release order makes the next borrower write only after the last reader has finished.
  free_.fetch_or(uint64_t{1} << slot, std::memory_order_release);
}

int FramePool::lent() const {
  return buffers() - std::popcount(free_.load(std::memory_order_relaxed));
}

}  // namespace bevloc::drivers
