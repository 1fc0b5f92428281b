#include "drivers/camera/v4l2/v4l2_camera.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <poll.h>

#include "common/cameras.h"
#include "common/kernel_time.h"
#include "drivers/camera/complete_image.h"
#include "drivers/camera/v4l2/controls.h"

namespace bevloc::drivers {

V4l2Camera::V4l2Camera(V4l2CameraConfig config, Clock& clock)
    : config_(std::move(config)), clock_(clock), buffers_(config_.device.buffers) {}

Status V4l2Camera::start() {
  const std::string_view name = kCameraNames[config_.device.camera];
  if (stream_) return fail("camera {}: already started", name);
  auto stream = open_stream();
  if (!stream) return fail("camera {}: {}", name, stream.error().message);
  const auto rule =
      v4l2::stamp_rule((*stream)->buffer_flags(), config_.device.exposure, config_.device.readout);
  if (!rule) {
    return fail("camera {}: {}: {}", name, (*stream)->device().name(), rule.error().message);
  }
  stream_ = std::move(*stream);
  stamp_rule_ = *rule;
  buffers_ = stream_->buffers();
  ignores_readout_ = rule->ignores_readout;
  counter_.restart();
  return {};
}

Result<std::shared_ptr<v4l2::Stream>> V4l2Camera::open_stream() const {
  const auto node = v4l2::find_video_node(config_.device.id);
  if (!node) return tl::unexpected(node.error());
  auto device = v4l2::Device::open(*node);
  if (!device) return tl::unexpected(device.error());
  const auto& controls = config_.device.controls;
  // Flips and rotations come first, because they decide which formats the device has.
  if (Status set = v4l2::set_controls(**device, controls, V4L2_CTRL_FLAG_MODIFY_LAYOUT); !set) {
    return tl::unexpected(set.error());
  }
  const auto format = v4l2::negotiate_format(**device, config_.device);
  if (!format) return tl::unexpected(format.error());
  if (Status set = v4l2::set_controls(**device, controls); !set) {
    return tl::unexpected(set.error());
  }
  if (!controls.empty()) {
    const Status kept = v4l2::check_kept_format(**device, *format);
    if (!kept) return tl::unexpected(kept.error());
  }
  return v4l2::Stream::open(std::move(*device), *format, config_.device.buffers, config_.memory);
}

void V4l2Camera::stop() {
  if (stream_) stream_->stop();
  stream_.reset();
}

Result<FrameEvent> V4l2Camera::next_frame(Duration timeout, Frame& frame) {
  if (!stream_) return fail("camera {}: not started", kCameraNames[config_.device.camera]);
  const Time give_up = clock_.now() + timeout;
  do {
    if (wait_until(give_up) == Wait::kTimeout) break;
    auto event = take(frame);
    if (!event || *event == FrameEvent::kFrame) return event;
  } while (clock_.now() < give_up);
  return FrameEvent::kTimeout;
}

/// ppoll() reports an error as readiness, too. dequeue() then returns the error.
V4l2Camera::Wait V4l2Camera::wait_until(Time time) const {
  const timespec limit = timespec_of(std::max(time - clock_.now(), Duration::zero()));
  pollfd entry{stream_->device().fd(), POLLIN, 0};
  return ppoll(&entry, 1, &limit, nullptr) > 0 ? Wait::kReady : Wait::kTimeout;
}

Result<FrameEvent> V4l2Camera::take(Frame& frame) {
  v4l2_buffer buffer;
  if (const int error = stream_->dequeue(buffer)) {
    if (error == EAGAIN) return FrameEvent::kTimeout;
    return fail("camera {}: {}: {}", kCameraNames[config_.device.camera], stream_->device().name(),
                error == ENODEV ? "is unplugged; check the cable" : std::strerror(error));
  }
  const uint64_t sequence = counter_.arrived(buffer.sequence);
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || !is_complete(stream_->view(buffer))) {
    counter_.damaged();
    stream_->requeue(buffer.index);
    return FrameEvent::kTimeout;
  }
  frame = Frame{config_.device.camera, v4l2::exposure_start(buffer.timestamp, stamp_rule_),
                sequence, config_.device.exposure, stream_->lend(buffer)};
  counter_.delivered(stream_->lent() == stream_->buffers());
  return FrameEvent::kFrame;
}

CameraDescription V4l2Camera::description() const {
  return {config_.device.camera, config_.device.width_px, config_.device.height_px, buffers_,
          ignores_readout_};
}

}  // namespace bevloc::drivers
