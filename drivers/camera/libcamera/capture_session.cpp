#include "drivers/camera/libcamera/capture_session.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <utility>

#include <sys/mman.h>

#include "drivers/camera/dmabuf.h"
#include "drivers/camera/libcamera/camera_ids.h"
#include "drivers/camera/libcamera/controls.h"

namespace bevloc::drivers::libcam {
namespace {

Result<std::shared_ptr<libcamera::Camera>> find_camera(libcamera::CameraManager& manager,
                                                       const std::string& id) {
  if (auto camera = manager.get(id)) return camera;
  return fail("{}", no_camera_called(id, ids_of(manager)));
}

}  // namespace

Result<std::shared_ptr<CaptureSession>> CaptureSession::open(
    std::shared_ptr<libcamera::CameraManager> manager, const DeviceCameraConfig& config) {
  auto camera = find_camera(*manager, config.id);
  if (!camera) return tl::unexpected(camera.error());
  std::shared_ptr<CaptureSession> session(
      new CaptureSession(std::move(manager), std::move(*camera)));
  Status ready = session->configure(config);
  if (ready) ready = session->make_requests();
  if (ready) ready = session->begin(config);
  if (!ready) return fail("{}: {}", config.id, ready.error().message);
  return session;
}

CaptureSession::~CaptureSession() {
  stop();
  for (const Mapping& mapping : mappings_) munmap(mapping.data, mapping.length);
}

Status CaptureSession::configure(const DeviceCameraConfig& config) {
  if (const int error = camera_->acquire()) {
    return fail("cannot be acquired: {}",
                error == -EBUSY ? "another program uses it" : std::strerror(-error));
  }
  is_acquired_ = true;
  configuration_ = camera_->generateConfiguration({libcamera::StreamRole::VideoRecording});
  if (!configuration_ || configuration_->empty()) return fail("has no video stream");
  const auto format = choose_format(*configuration_, config);
  if (!format) return tl::unexpected(format.error());
  if (const int error = camera_->configure(configuration_.get())) {
    return fail("cannot be configured: {}", std::strerror(-error));
  }
  const libcamera::StreamConfiguration& stream = configuration_->at(0);
  stream_ = stream.stream();
  layout_ = {*format, config.width_px, config.height_px, stream.stride, yuv_encoding(stream)};
  return {};
}

Status CaptureSession::make_requests() {
  if (const int error = allocator_.allocate(stream_); error < 0) {
    return fail("buffers cannot be allocated: {}", std::strerror(-error));
  }
  for (const auto& buffer : allocator_.buffers(stream_)) {
    if (Status mapped = map(*buffer); !mapped) return mapped;
    auto request = camera_->createRequest(requests_.size());
    if (!request || request->addBuffer(stream_, buffer.get()) != 0) {
      return fail("a request cannot be created");
    }
    requests_.push_back(std::move(request));
  }
  completed_.set_capacity(requests_.size());
  return {};
}

/// Maps a buffer. All planes must be in one dmabuf, as they are for the formats that bevloc uses.
Status CaptureSession::map(const libcamera::FrameBuffer& buffer) {
  Mapping mapping;
  mapping.dmabuf = buffer.planes().front().fd.get();
  for (const libcamera::FrameBuffer::Plane& plane : buffer.planes()) {
    if (plane.fd.get() != mapping.dmabuf)
      return fail("found planes in several dmabufs, wanted one");
    mapping.length = std::max<size_t>(mapping.length, plane.offset + plane.length);
  }
  void* memory = mmap(nullptr, mapping.length, PROT_READ, MAP_SHARED, mapping.dmabuf, 0);
  if (memory == MAP_FAILED) return fail("a buffer cannot be mapped: {}", std::strerror(errno));
  mapping.data = static_cast<uint8_t*>(memory);
  mappings_.push_back(mapping);
  return {};
}

Status CaptureSession::begin(const DeviceCameraConfig& config) {
  const auto controls = start_controls(*camera_, config);
  if (!controls) return tl::unexpected(controls.error());
  camera_->requestCompleted.connect(this, &CaptureSession::on_completed);
  camera_->disconnected.connect(this, &CaptureSession::on_disconnected);
  if (const int error = camera_->start(&*controls)) {
    return fail("cannot be started: {}", std::strerror(-error));
  }
  running_ = true;
  for (const auto& request : requests_) {
    if (const int error = camera_->queueRequest(request.get())) {
      return fail("a request cannot be queued: {}", std::strerror(-error));
    }
  }
  return {};
}

void CaptureSession::stop() {
  if (!is_acquired_) return;
  is_acquired_ = false;
  running_ = false;
  // libcamera completes the queued requests as cancelled before this call returns.
  camera_->stop();
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  camera_->release();
}

void CaptureSession::on_completed(libcamera::Request* request) {
  if (request->status() == libcamera::Request::RequestCancelled) return;
  {
    const std::lock_guard lock(mutex_);
    completed_.push_back(static_cast<int>(request->cookie()));
  }
  changed_.notify_one();
}

void CaptureSession::on_disconnected() {
  {
    const std::lock_guard lock(mutex_);
    is_disconnected_ = true;
  }
  changed_.notify_one();
}

CaptureSession::Event CaptureSession::wait(Duration timeout, int& slot) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return is_disconnected_ || !completed_.empty(); });
  if (is_disconnected_) return Event::kDisconnected;
  if (completed_.empty()) return Event::kTimeout;
  slot = completed_.front();
  completed_.pop_front();
  return Event::kCompleted;
}

const libcamera::FrameMetadata& CaptureSession::frame_metadata(int slot) const {
  return requests_[slot]->findBuffer(stream_)->metadata();
}

std::optional<int64_t> CaptureSession::sensor_timestamp_ns(int slot) const {
  return requests_[slot]->metadata().get(libcamera::controls::SensorTimestamp);
}

ImageView CaptureSession::view(int slot) const {
  const auto& planes = requests_[slot]->findBuffer(stream_)->planes();
  const uint8_t* data = mappings_[slot].data;
  ImageView view;
  view.format = layout_.format;
  view.width = layout_.width_px;
  view.height = layout_.height_px;
  view.planes[0] = {data + planes[0].offset, layout_.stride_bytes};
  if (layout_.format == PixelFormat::kNv12) {
    const size_t chroma = planes.size() > 1
                              ? planes[1].offset
                              : planes[0].offset + static_cast<size_t>(layout_.stride_bytes) *
                                                       static_cast<size_t>(layout_.height_px);
    view.planes[1] = {data + chroma, layout_.stride_bytes};
  }
  view.yuv = layout_.yuv;
  for (const auto& plane : frame_metadata(slot).planes()) view.bytes_used += plane.bytesused;
  return view;
}

FrameBuffer CaptureSession::lend(int slot) {
  begin_dmabuf_read(mappings_[slot].dmabuf);
  lent_.fetch_add(1, std::memory_order_relaxed);
  return {shared_from_this(), slot, view(slot)};
}

void CaptureSession::give_back(int slot) noexcept {
  end_dmabuf_read(mappings_[slot].dmabuf);
  requeue(slot);
  lent_.fetch_sub(1, std::memory_order_relaxed);
}

void CaptureSession::requeue(int slot) noexcept {
  // After stop() a request cannot be queued. If stop() comes after this check, libcamera refuses
  // it.
  if (!running_) return;
  requests_[slot]->reuse(libcamera::Request::ReuseBuffers);
  camera_->queueRequest(requests_[slot].get());
}

}  // namespace bevloc::drivers::libcam
