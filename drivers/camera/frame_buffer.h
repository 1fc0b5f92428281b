// A picture on loan from whoever owns its memory.
#pragma once

#include <memory>
#include <utility>

#include "common/image_view.h"

namespace bevloc::drivers {

/// Owns pictures and lends them out: a pool of its own, or a device's buffers.
class FrameLender {
 public:
  virtual ~FrameLender() = default;

 private:
  friend class FrameBuffer;
  /// From any thread, also after the camera is gone; neither blocks nor fails.
  virtual void give_back(int slot) noexcept = 0;
};

/// Dropping it gives the picture back to its lender, from any thread, also after the camera that
/// filled it has stopped or is gone; until then the lender lives. Empty when default-constructed or
/// moved from.
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
  /// Which of the lender's pictures it is.
  int slot() const { return slot_; }
  /// The lender's memory itself: nothing is copied.
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
