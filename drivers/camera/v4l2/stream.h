// The buffers of a V4L2 device, from one start() to its stop().
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include <linux/videodev2.h>

#include "common/file_descriptor.h"
#include "drivers/camera/frame_buffer.h"
#include "drivers/camera/v4l2/device.h"
#include "drivers/camera/v4l2/format_negotiation.h"

namespace bevloc::drivers::v4l2 {

/// How buffers are mapped: directly from the device, or exported as dmabuf and mapped from there.
/// An accelerator could read a dmabuf, too.
enum class MemoryAccess : uint8_t { kMapped, kDmabuf };

/// A frame that is held keeps the memory and the file descriptor of the stream alive. stop()
/// releases the device, so that a new stream can start.
/// Thread-bound: called from the camera's own thread. A frame may be dropped by any thread.
class Stream final : public FrameLender, public std::enable_shared_from_this<Stream> {
 public:
  /// Allocates, maps and queues the buffers and starts streaming. The driver may allocate fewer or
  /// more buffers than `buffers`.
  static Result<std::shared_ptr<Stream>> open(std::shared_ptr<Device> device,
                                              const StreamFormat& format, int buffers,
                                              MemoryAccess access);
  ~Stream() override;

  /// Releases the device for the next stream. Frames that are held stay readable.
  void stop();

  /// Fetches a filled buffer. Returns 0, EAGAIN if there is none, or another errno.
  int dequeue(v4l2_buffer& buffer) const;
  /// Lends a dequeued buffer to the user.
  FrameBuffer lend(const v4l2_buffer& buffer);
  /// Queues a dequeued buffer again. Thread-safe.
  void requeue(uint32_t slot) const noexcept;

  /// Returns the image in a dequeued buffer.
  ImageView view(const v4l2_buffer& buffer) const;
  int buffers() const { return static_cast<int>(mappings_.size()); }
  int lent() const { return lent_.load(std::memory_order_relaxed); }
  const Device& device() const { return *device_; }
  const StreamFormat& format() const { return format_; }
  /// Flags (V4L2_BUF_FLAG_*) that say how the device stamps its frames.
  uint32_t buffer_flags() const { return buffer_flags_; }

 private:
  struct Mapping {
    uint8_t* data = nullptr;
    size_t length = 0;
    FileDescriptor dmabuf;  ///< none if the device itself is mapped
  };

  Stream(std::shared_ptr<Device> device, const StreamFormat& format)
      : device_(std::move(device)), format_(format) {}
  Status make_buffers(int count, MemoryAccess access);
  Status map_buffer(uint32_t slot, MemoryAccess access);
  Status begin();
  void release_buffers();
  void give_back(int slot) noexcept override;

  const std::shared_ptr<Device> device_;
  const StreamFormat format_;
  std::vector<Mapping> mappings_;
  uint32_t buffer_flags_ = 0;
  std::atomic<int> lent_{0};
  std::atomic<bool> running_{false};
};

}  // namespace bevloc::drivers::v4l2
