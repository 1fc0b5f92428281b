#include "drivers/camera/frame_pool.h"

#include <bit>
#include <cassert>
#include <utility>

namespace bevloc::drivers {

FrameBuffer::FrameBuffer(FrameBuffer&& other) noexcept
    : pool_(std::move(other.pool_)), slot_(other.slot_) {}

FrameBuffer& FrameBuffer::operator=(FrameBuffer&& other) noexcept {
  if (this != &other) {
    give_back();
    pool_ = std::move(other.pool_);
    slot_ = other.slot_;
  }
  return *this;
}

RgbImage& FrameBuffer::image() {
  assert(pool_);
  return pool_->images_[slot_];
}

RgbView FrameBuffer::view() const {
  assert(pool_);
  return pool_->images_[slot_].view();
}

void FrameBuffer::give_back() {
  if (!pool_) return;
  // Release: whoever borrows the picture next sees that its last reader is done with it.
  pool_->free_.fetch_or(uint64_t{1} << slot_, std::memory_order_release);
  pool_.reset();
}

std::shared_ptr<FramePool> FramePool::create(int buffers, int width_px, int height_px) {
  return std::shared_ptr<FramePool>(new FramePool(buffers, width_px, height_px));
}

FramePool::FramePool(int buffers, int width_px, int height_px)
    : images_(buffers, RgbImage(width_px, height_px)),
      free_(~uint64_t{0} >> (kMaxBuffers - buffers)) {
  assert(buffers >= 1 && buffers <= kMaxBuffers);
}

FrameBuffer FramePool::borrow() {
  uint64_t free = free_.load(std::memory_order_relaxed);
  while (free != 0) {
    const uint64_t without_lowest = free & (free - 1);
    if (free_.compare_exchange_weak(free, without_lowest, std::memory_order_acquire,
                                    std::memory_order_relaxed)) {
      return {shared_from_this(), std::countr_zero(free)};
    }
  }
  return {};
}

int FramePool::lent() const {
  return buffers() - std::popcount(free_.load(std::memory_order_relaxed));
}

}  // namespace bevloc::drivers
