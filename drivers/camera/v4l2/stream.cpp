#include "drivers/camera/v4l2/stream.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>

#include "drivers/camera/dmabuf.h"

namespace bevloc::drivers::v4l2 {
namespace {

v4l2_buffer capture_buffer(uint32_t slot) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = slot;
  return buffer;
}

}  // namespace

Result<std::shared_ptr<Stream>> Stream::open(std::shared_ptr<Device> device,
                                             const StreamFormat& format, int buffers,
                                             MemoryAccess access) {
  std::shared_ptr<Stream> stream(new Stream(std::move(device), format));
  Status ready = stream->make_buffers(buffers, access);
  if (ready) ready = stream->begin();
  if (!ready) {
    stream->release_buffers();
    return tl::unexpected(ready.error());
  }
  return stream;
}

Stream::~Stream() {
  stop();
  for (const Mapping& mapping : mappings_) {
    if (mapping.data != nullptr) munmap(mapping.data, mapping.length);
  }
}

Status Stream::make_buffers(int count, MemoryAccess access) {
  v4l2_requestbuffers request{};
  request.count = static_cast<uint32_t>(count);
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (const int error = device_->call(VIDIOC_REQBUFS, &request)) {
    return fail("{}: {} buffers cannot be allocated: {}", device_->name(), count,
                std::strerror(error));
  }
  mappings_.resize(request.count);
  for (uint32_t slot = 0; slot < request.count; ++slot) {
    if (Status mapped = map_buffer(slot, access); !mapped) return mapped;
  }
  return {};
}

Status Stream::map_buffer(uint32_t slot, MemoryAccess access) {
  v4l2_buffer buffer = capture_buffer(slot);
  if (const int error = device_->call(VIDIOC_QUERYBUF, &buffer)) {
    return fail("{}: buffer {} cannot be queried: {}", device_->name(), slot, std::strerror(error));
  }
  buffer_flags_ = buffer.flags;
  Mapping& mapping = mappings_[slot];
  mapping.length = buffer.length;
  int fd = device_->fd();
  off_t offset = buffer.m.offset;
  if (access == MemoryAccess::kDmabuf) {
    v4l2_exportbuffer request{};
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.index = slot;
    request.flags = O_RDWR | O_CLOEXEC;
    if (const int error = device_->call(VIDIOC_EXPBUF, &request)) {
      return fail("{}: buffers cannot be exported as dmabuf ({}); set `memory: mmap`",
                  device_->name(), std::strerror(error));
    }
    mapping.dmabuf.reset(request.fd);
    fd = request.fd;
    offset = 0;
  }
  void* memory = mmap(nullptr, mapping.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
  if (memory == MAP_FAILED) {
    return fail("{}: buffer {} cannot be mapped: {}", device_->name(), slot, std::strerror(errno));
  }
  mapping.data = static_cast<uint8_t*>(memory);
  return {};
}

Status Stream::begin() {
  for (uint32_t slot = 0; slot < mappings_.size(); ++slot) {
    v4l2_buffer buffer = capture_buffer(slot);
    if (const int error = device_->call(VIDIOC_QBUF, &buffer)) {
      return fail("{}: buffer {} cannot be queued: {}", device_->name(), slot,
                  std::strerror(error));
    }
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int error = device_->call(VIDIOC_STREAMON, &type)) {
    return fail("{}: cannot start streaming: {}", device_->name(), std::strerror(error));
  }
  running_ = true;
  return {};
}

void Stream::stop() {
  if (!running_.exchange(false)) return;
  // Both calls can fail only when the device was unplugged.
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_->call(VIDIOC_STREAMOFF, &type);
  release_buffers();
}

/// Makes the kernel release its buffers and the ownership of the stream. Mapped memory stays valid.
void Stream::release_buffers() {
  v4l2_requestbuffers request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  device_->call(VIDIOC_REQBUFS, &request);
}

int Stream::dequeue(v4l2_buffer& buffer) const {
  buffer = capture_buffer(0);
  return device_->call(VIDIOC_DQBUF, &buffer);
}

ImageView Stream::view(const v4l2_buffer& buffer) const {
  ImageView view = view_of(format_.format, format_.pixels, mappings_[buffer.index].data);
  view.bytes_used = buffer.bytesused;
  return view;
}

FrameBuffer Stream::lend(const v4l2_buffer& buffer) {
  const int dmabuf = mappings_[buffer.index].dmabuf.get();
  if (dmabuf >= 0) begin_dmabuf_read(dmabuf);
  lent_.fetch_add(1, std::memory_order_relaxed);
  return {shared_from_this(), static_cast<int>(buffer.index), view(buffer)};
}

void Stream::give_back(int slot) noexcept {
  const auto index = static_cast<uint32_t>(slot);
  if (const int dmabuf = mappings_[index].dmabuf.get(); dmabuf >= 0) end_dmabuf_read(dmabuf);
  requeue(index);
  lent_.fetch_sub(1, std::memory_order_relaxed);
}

void Stream::requeue(uint32_t slot) const noexcept {
  // After stop() a buffer cannot be queued. If stop() comes after this check, the kernel refuses
  // it.
  if (!running_) return;
  v4l2_buffer buffer = capture_buffer(slot);
  device_->call(VIDIOC_QBUF, &buffer);
}

}  // namespace bevloc::drivers::v4l2
