#include "drivers/camera/libcamera/libcamera_camera.h"

#include <cstring>
#include <mutex>
#include <utility>

#include "common/cameras.h"
#include "drivers/camera/complete_image.h"
#include "drivers/camera/libcamera/camera_ids.h"
#include "drivers/camera/libcamera/capture_session.h"
#include "drivers/camera/libcamera/sensor_time.h"

namespace bevloc::drivers {
namespace {

/// All cameras share one manager, because libcamera allows only one per process. The last user ends
/// it.
class SharedManager {
 public:
  Result<std::shared_ptr<libcamera::CameraManager>> use() {
    const std::lock_guard lock(mutex_);
    if (users_ == 0) {
      manager_ = std::make_unique<libcamera::CameraManager>();
      if (const int error = manager_->start()) {
        manager_.reset();
        return fail("libcamera cannot be started: {}", std::strerror(-error));
      }
    }
    ++users_;
    return std::shared_ptr<libcamera::CameraManager>(
        manager_.get(), [this](libcamera::CameraManager*) { release(); });
  }

 private:
  /// Ends the manager while it holds the lock, because libcamera ends the process if another
  /// manager begins before this one has ended.
  void release() {
    const std::lock_guard lock(mutex_);
    if (--users_ == 0) manager_.reset();
  }

  std::mutex mutex_;
  int users_ = 0;
  std::unique_ptr<libcamera::CameraManager> manager_;
};

Result<std::shared_ptr<libcamera::CameraManager>> shared_manager() {
  static SharedManager shared;
  return shared.use();
}

}  // namespace

std::vector<std::string> libcamera_ids() {
  const auto manager = shared_manager();
  return manager ? libcam::ids_of(**manager) : std::vector<std::string>();
}

LibcameraCamera::LibcameraCamera(DeviceCameraConfig config, Clock& clock)
    : config_(std::move(config)), clock_(clock), buffers_(config_.buffers) {}

LibcameraCamera::~LibcameraCamera() {
  stop();
}

Status LibcameraCamera::start() {
  const std::string_view name = kCameraNames[config_.camera];
  if (session_) return fail("camera {}: already started", name);
  if (!manager_) {
    auto manager = shared_manager();
    if (!manager) return fail("camera {}: {}", name, manager.error().message);
    manager_ = std::move(*manager);
  }
  auto session = libcam::CaptureSession::open(manager_, config_);
  if (!session) return fail("camera {}: {}", name, session.error().message);
  session_ = std::move(*session);
  buffers_ = session_->buffers();
  counter_.restart();
  return {};
}

void LibcameraCamera::stop() {
  if (session_) session_->stop();
  session_.reset();
}

Result<FrameEvent> LibcameraCamera::next_frame(Duration timeout, Frame& frame) {
  if (!session_) return fail("camera {}: not started", kCameraNames[config_.camera]);
  const Time give_up = clock_.now() + timeout;
  do {
    int slot = 0;
    switch (session_->wait(std::max(give_up - clock_.now(), Duration::zero()), slot)) {
      case libcam::CaptureSession::Event::kDisconnected:
        return fail("camera {}: {}: is unplugged; check the cable", kCameraNames[config_.camera],
                    config_.id);
      case libcam::CaptureSession::Event::kTimeout:
        return FrameEvent::kTimeout;
      case libcam::CaptureSession::Event::kCompleted:
        if (take(slot, frame)) return FrameEvent::kFrame;
    }
  } while (clock_.now() < give_up);
  return FrameEvent::kTimeout;
}

bool LibcameraCamera::take(int slot, Frame& frame) {
  const libcamera::FrameMetadata& metadata = session_->frame_metadata(slot);
  const uint64_t sequence = counter_.arrived(metadata.sequence);
  const auto timestamp_ns = session_->sensor_timestamp_ns(slot);
  if (metadata.status != libcamera::FrameMetadata::FrameSuccess || !timestamp_ns ||
      !is_complete(session_->view(slot))) {
    counter_.damaged();
    session_->requeue(slot);
    return false;
  }
  const Time stamp = libcam::steady_time(*timestamp_ns, clock_.now(), clock_.suspended());
  const Time time = libcam::exposure_start(stamp, config_.exposure, config_.readout);
  frame = Frame{config_.camera, time, sequence, config_.exposure, session_->lend(slot)};
  counter_.delivered(session_->lent() == session_->buffers());
  return true;
}

CameraDescription LibcameraCamera::description() const {
  return {config_.camera, config_.width_px, config_.height_px, buffers_};
}

}  // namespace bevloc::drivers
