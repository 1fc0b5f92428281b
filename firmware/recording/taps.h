// Cameras and bus that hand what passes through them to the recorder.
#pragma once

#include <memory>

#include "can/bus/bus.h"
#include "drivers/camera/camera.h"
#include "drivers/clock/clock.h"
#include "firmware/recording/recorder.h"

namespace bevloc::firmware {

/// Behaves as the camera that it owns, and copies each frame for the recorder. The thread rule is
/// that of Camera.
class RecordedCamera final : public drivers::Camera {
 public:
  /// `recorder` and `clock` must outlive the camera.
  RecordedCamera(std::unique_ptr<drivers::Camera> camera, Recorder& recorder,
                 const drivers::Clock& clock)
      : camera_(std::move(camera)), recorder_(recorder), clock_(clock) {
    const drivers::CameraDescription shape = camera_->description();
    recorder_.expect_images(shape.camera, shape.width_px, shape.height_px);
  }

  Status start() override { return camera_->start(); }
  void stop() override { camera_->stop(); }
  Result<drivers::FrameEvent> next_frame(Duration timeout, drivers::Frame& frame) override {
    auto event = camera_->next_frame(timeout, frame);
    if (event && *event == drivers::FrameEvent::kFrame) recorder_.note_image(frame, clock_.now());
    return event;
  }
  drivers::CameraDescription description() const override { return camera_->description(); }
  drivers::CameraCounters counters() const override { return camera_->counters(); }

 private:
  std::unique_ptr<drivers::Camera> camera_;
  Recorder& recorder_;
  const drivers::Clock& clock_;
};

/// Behaves as the bus endpoint that it owns. Tells the recorder of each frame that it receives, and
/// of each frame that is given to send(). The latter are recorded even if the bus does not take
/// them, because a replay makes the same frames. The thread rule is that of Bus.
class RecordedBus final : public can::Bus {
 public:
  /// `recorder` and `clock` must outlive the bus.
  RecordedBus(std::unique_ptr<can::Bus> bus, Recorder& recorder, const drivers::Clock& clock)
      : bus_(std::move(bus)), recorder_(recorder), clock_(clock) {}

  can::SendResult send(const can::Frame& frame, Time now) override {
    recorder_.note_bus_frame({now, true, frame, now});
    return bus_->send(frame, now);
  }
  std::optional<can::ReceivedFrame> receive() override {
    auto received = bus_->receive();
    if (received) {
      recorder_.note_bus_frame({clock_.now(), false, received->frame, received->received});
    }
    return received;
  }
  bool wait(Duration timeout) override { return bus_->wait(timeout); }
  can::BusCounters counters() const override { return bus_->counters(); }
  can::BusCondition condition() const override { return bus_->condition(); }

 private:
  std::unique_ptr<can::Bus> bus_;
  Recorder& recorder_;
  const drivers::Clock& clock_;
};

}  // namespace bevloc::firmware
