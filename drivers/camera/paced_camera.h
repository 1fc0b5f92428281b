// What cameras without hardware share: pictures that are made ahead and handed over on time.
#pragma once

#include <atomic>
#include <optional>

#include "drivers/camera/camera.h"
#include "drivers/camera/frame_pool.h"
#include "drivers/clock/clock.h"

namespace bevloc::drivers {

/// One picture that will arrive.
struct Delivery {
  uint64_t sequence = 0;
  Time exposure_start;
  Time scene_time;  ///< of what the picture shows; behind exposure_start when it is frozen
  Time due;         ///< when it arrives
};

/// Makes each picture as soon as the one before has been fetched and hands it over when it is due,
/// as a sensor would: the cost of making it is no latency. On a virtual clock the same code runs in
/// lockstep. A picture that is `shelf_life` overdue when it is looked for, or when it is made at
/// last, is lost (overrun): on a machine that is too slow frames are missing, never stale.
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

  /// Gets ready to deliver what is due from `now` on.
  virtual Status open(Time now) = 0;
  /// In order of `due`; nothing when there will be no more. Called after open() alone.
  virtual std::optional<Delivery> next_delivery() = 0;
  virtual Status draw(const Delivery& delivery, RgbImage& image) = 0;

  void set_shelf_life(Duration shelf_life) { shelf_life_ = shelf_life; }

 private:
  struct AtomicCounters {
    std::atomic<uint64_t> delivered{0};
    std::atomic<uint64_t> no_buffer{0};
    std::atomic<uint64_t> overrun{0};
  };

  bool is_overdue() const;
  void drop_overdue();
  Status draw_next();
  bool hand_over(Frame& frame);
  void advance();

  const CameraDescription description_;
  const Duration exposure_;
  Clock& clock_;
  Duration shelf_life_ = Duration::max();
  std::shared_ptr<FramePool> pool_;
  std::optional<Delivery> next_;
  FrameBuffer drawn_;  ///< the picture of next_, once it is made
  bool running_ = false;
  AtomicCounters counters_;
};

}  // namespace bevloc::drivers
