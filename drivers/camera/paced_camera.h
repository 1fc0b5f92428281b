// Base class of cameras without hardware: draws each frame ahead and delivers it on time.
#pragma once

#include <atomic>
#include <optional>

#include "drivers/camera/camera.h"
#include "drivers/camera/frame_pool.h"
#include "drivers/clock/clock.h"

namespace bevloc::drivers {

/// A frame that will be delivered.
struct Delivery {
  uint64_t sequence = 0;
  Time exposure_start;
  /// The moment that the image shows. It is before exposure_start if the image is frozen.
  Time scene_time;
  Time due;           ///< when the frame arrives
  bool lost = false;  ///< the frame does not arrive
};

/// Draws each frame as soon as the previous one was fetched, and delivers it when it is due, as a
/// sensor would. So the drawing time adds no latency. With a virtual clock the same code runs in
/// lockstep. If a frame is late by `max_lateness` or more when it is fetched or when its drawing
/// ends, it is dropped and counted as overrun. So a machine that is too slow loses frames, but
/// delivers no stale ones.
class PacedCamera : public Camera {
 public:
  Status start() final;
  void stop() final;
  Result<FrameEvent> next_frame(Duration timeout, Frame& frame) final;
  CameraDescription description() const final { return description_; }
  CameraCounters counters() const final;

 protected:
  /// The clock must outlive the camera.
  PacedCamera(const CameraDescription& description, Duration exposure, Clock& clock);

  /// Prepares the deliveries that are due from `now` on.
  virtual Status open(Time now) = 0;
  /// Returns the deliveries in order of `due`, and nothing after the last one. It is called after
  /// open().
  virtual std::optional<Delivery> next_delivery() = 0;
  virtual Status draw(const Delivery& delivery, RgbImage& image) = 0;

  void set_max_lateness(Duration max_lateness) { max_lateness_ = max_lateness; }

 private:
  struct AtomicCounters {
    std::atomic<uint64_t> delivered{0};
    std::atomic<uint64_t> no_buffer{0};
    std::atomic<uint64_t> overrun{0};
    std::atomic<uint64_t> damaged{0};  ///< frames that could not be drawn
  };

  bool is_overdue() const;
  void drop_overdue();
  Status draw_next();
  bool deliver(Frame& frame);
  void advance();

  const CameraDescription description_;
  const Duration exposure_;
  Clock& clock_;
  Duration max_lateness_ = Duration::max();
  std::shared_ptr<FramePool> pool_;
  std::optional<Delivery> next_;
  FrameBuffer drawn_;  ///< the image of next_, if it is drawn already
  bool running_ = false;
  AtomicCounters counters_;
};

}  // namespace bevloc::drivers
