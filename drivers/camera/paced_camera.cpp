#include "drivers/camera/paced_camera.h"

#include <utility>

#include "common/cameras.h"

namespace bevloc::drivers {
namespace {

/// A frame is drawn only if it is due at most this long after the end of the wait. A frame that is
/// due later, for example after a fault of a mock camera, is drawn later.
constexpr Duration kDrawAhead = std::chrono::seconds(1);

}  // namespace

PacedCamera::PacedCamera(const CameraDescription& description, Duration exposure, Clock& clock)
    : description_(description),
      exposure_(exposure),
      clock_(clock),
      pool_(FramePool::create(description.buffers, description.width_px, description.height_px)) {}

Status PacedCamera::start() {
  if (running_) return fail("camera {}: already started", kCameraNames[description_.camera]);
  if (Status opened = open(clock_.now()); !opened) return opened;
  running_ = true;
  advance();
  return {};
}

void PacedCamera::stop() {
  running_ = false;
  next_.reset();
  drawn_ = {};
}

Result<FrameEvent> PacedCamera::next_frame(Duration timeout, Frame& frame) {
  if (!running_) return fail("camera {}: not started", kCameraNames[description_.camera]);
  const Time give_up = clock_.now() + timeout;
  do {
    drop_overdue();
    if (!next_) return FrameEvent::kEnded;
    if (!next_->lost && next_->due <= give_up + kDrawAhead) {
      if (Status drawn = draw_next(); !drawn) {
        counters_.damaged.fetch_add(1, std::memory_order_relaxed);
        advance();
        return tl::unexpected(drawn.error());
      }
    }
    if (is_overdue()) continue;  // drawing took too long
    if (next_->due > give_up) {
      clock_.sleep_until(give_up);
      return FrameEvent::kTimeout;
    }
    clock_.sleep_until(next_->due);
    if (next_->lost) {
      advance();
      continue;
    }
    if (deliver(frame)) return FrameEvent::kFrame;
  } while (clock_.now() <= give_up);
  return FrameEvent::kTimeout;
}

/// Delivers the frame of next_ and advances to the following one. Returns false when no buffer was
/// free.
bool PacedCamera::deliver(Frame& frame) {
  const bool has_buffer = static_cast<bool>(drawn_);
  if (has_buffer) {
    frame = Frame{description_.camera, next_->exposure_start, next_->sequence, exposure_,
                  std::move(drawn_)};
  }
  std::atomic<uint64_t>& counter = has_buffer ? counters_.delivered : counters_.no_buffer;
  counter.fetch_add(1, std::memory_order_relaxed);
  advance();
  return has_buffer;
}

CameraCounters PacedCamera::counters() const {
  return {counters_.delivered.load(std::memory_order_relaxed),
          counters_.no_buffer.load(std::memory_order_relaxed),
          counters_.overrun.load(std::memory_order_relaxed), 0,
          counters_.damaged.load(std::memory_order_relaxed)};
}

bool PacedCamera::is_overdue() const {
  return next_ && clock_.now() - next_->due >= max_lateness_;
}

void PacedCamera::drop_overdue() {
  while (is_overdue()) {
    if (!next_->lost) counters_.overrun.fetch_add(1, std::memory_order_relaxed);
    advance();
  }
}

/// Draws the image of next_, unless it is drawn already or no buffer is free.
Status PacedCamera::draw_next() {
  if (drawn_) return {};
  drawn_ = pool_->borrow();
  if (!drawn_) return {};
  return draw(*next_, pool_->image(drawn_));
}

void PacedCamera::advance() {
  drawn_ = {};
  next_ = next_delivery();
}

}  // namespace bevloc::drivers
