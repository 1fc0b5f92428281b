// A frame buffer that is lent by the owner of its memory and returned when it is dropped.
#pragma once

#include <memory>
#include <utility>

#include "common/image_view.h"

namespace bevloc::drivers {

/// Owns frame buffers and lends them: a pool, or the buffers of a device.
class FrameLender {
 public:
  virtual ~FrameLender() = default;

 private:
  friend class FrameBuffer;
  /// Takes a buffer back. Thread-safe, also after the camera is destroyed. Does not block or fail.
  virtual void give_back(int slot) noexcept = 0;
};

/// A buffer on loan. Dropping it gives the memory back to the lender. Any thread may do that, also
/// after the camera that filled the buffer was stopped or destroyed, because the buffer keeps its
/// lender alive. A buffer that is default-constructed or moved from is empty.
class FrameBuffer {
 public:
  FrameBuffer() = default;
  FrameBuffer(std::shared_ptr<FrameLender> lender, int slot, const ImageView& view)
      : lender_(std::move(lender)), slot_(slot), view_(view) {}
  FrameBuffer(FrameBuffer&& other) noexcept = default;
  FrameBuffer& operator=(FrameBuffer&& other) noexcept {
    if (this != &other) {
      give_back();
      lender_ = std::move(other.lender_);
      slot_ = other.slot_;
      view_ = other.view_;
    }
    return *this;
  }
  FrameBuffer(const FrameBuffer&) = delete;
  FrameBuffer& operator=(const FrameBuffer&) = delete;
  ~FrameBuffer() { give_back(); }

  explicit operator bool() const { return lender_ != nullptr; }
  /// The lender's number of this buffer.
  int slot() const { return slot_; }
  /// A view of the lender's memory, without a copy.
  const ImageView& view() const { return view_; }

 private:
  void give_back() noexcept {
    if (lender_) lender_->give_back(slot_);
    lender_.reset();
  }

  std::shared_ptr<FrameLender> lender_;
  int slot_ = 0;
  ImageView view_;
};

}  // namespace bevloc::drivers
