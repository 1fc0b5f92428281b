// Cameras and a bus that play a recording into the appliance.
#pragma once

#include <functional>
#include <vector>

#include "can/bus/bus.h"
#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "evaluation/recording/recording.h"
#include "pipeline/calibration/camera_model.h"

namespace bevloc::evaluation {

/// Delivers each frame at the time when the appliance got it, with its times and its image. Does
/// not wait, so it is for a virtual clock. A frame that cannot be read is an error once; the next
/// call goes on with the following frame. One thread.
class PlayedCamera final : public drivers::Camera {
 public:
  /// `recording` and `clock` must outlive the camera.
  PlayedCamera(Recording& recording, int camera, int width_px, int height_px,
               const drivers::Clock& clock);

  Status start() override;
  void stop() override { running_ = false; }
  Result<drivers::FrameEvent> next_frame(Duration timeout, drivers::Frame& frame) override;
  drivers::CameraDescription description() const override;
  drivers::CameraCounters counters() const override { return counters_; }

 private:
  Recording& recording_;
  const drivers::Clock& clock_;
  const int camera_;
  const int width_px_;
  const int height_px_;
  const std::vector<MessagePlace>& places_;
  const bool raw_;
  size_t next_ = 0;
  bool running_ = false;
  drivers::CameraCounters counters_;
};

/// A frame that the appliance received, and when.
struct PlayedFrame {
  Time delivered;
  can::ReceivedFrame frame;
};

/// Delivers each frame at the time when the appliance got it, and reports the frames that the
/// appliance sends. Does not wait. One thread.
class PlayedBus final : public can::Bus {
 public:
  using Seen = std::function<void(const can::Frame& frame, Time time, bool sent)>;

  /// `frames` must be in the order of time. `clock` must outlive the bus. `seen` is called for each
  /// frame on the bus, in the order of the bus.
  PlayedBus(std::vector<PlayedFrame> frames, const drivers::Clock& clock, Seen seen)
      : frames_(std::move(frames)), clock_(clock), seen_(std::move(seen)) {}

  can::SendResult send(const can::Frame& frame, Time now) override;
  std::optional<can::ReceivedFrame> receive() override;
  bool wait(Duration timeout) override;
  can::BusCounters counters() const override { return counters_; }
  can::BusCondition condition() const override { return {.state = can::BusState::kActive}; }

 private:
  const std::vector<PlayedFrame> frames_;
  const drivers::Clock& clock_;
  const Seen seen_;
  size_t next_ = 0;
  can::BusCounters counters_;
};

/// The recorded frames of a topic, in the order of time.
Result<std::vector<PlayedFrame>> played_frames(Recording& recording, std::string_view topic);

/// The camera's frame of this number. `lens` states the size that its images should have.
Result<drivers::Frame> read_recorded_frame(Recording& recording, int camera, size_t number,
                                           const Intrinsics& lens);

/// The recorded image as RGB, for people.
Result<RgbImage> picture_at(Recording& recording, int camera, const MessagePlace& place);

}  // namespace bevloc::evaluation
