// A V4L2 device's buffers while it streams, and after.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include <linux/videodev2.h>

#include "drivers/camera/frame_buffer.h"
#include "drivers/camera/v4l2/device.h"
#include "drivers/camera/v4l2/format_negotiation.h"

namespace bevloc::drivers::v4l2 {

/// How the pictures' memory is reached: mapped from the device, or exported as dmabuf (so that an
/// accelerator could read them too) and mapped from there.
enum class MemoryAccess : uint8_t { kMapped, kDmabuf };

/// From one start() to its stop(). Whoever holds a picture keeps the stream's memory and its file
/// descriptor; the device itself is given up by stop(), so that a new stream can begin. open(),
/// dequeue(), lend() and stop() belong to one thread.
class Stream final : public FrameLender, public std::enable_shared_from_this<Stream> {
 public:
  /// Buffers are made, mapped and queued, and the device streams. The driver may give fewer or more
  /// buffers than asked for.
  static Result<std::shared_ptr<Stream>> open(std::shared_ptr<Device> device,
                                              const StreamFormat& format, int buffers,
                                              MemoryAccess access);
  ~Stream() override;

  /// Frees the device for the next stream; pictures that are held stay readable.
  void stop();

  /// 0, EAGAIN when there is none, or what is wrong.
  int dequeue(v4l2_buffer& buffer) const;
  /// A picture that was dequeued, to its user.
  FrameBuffer lend(const v4l2_buffer& buffer);
  /// Back to the device without having been lent. From any thread.
  void requeue(uint32_t slot) const noexcept;

  /// The picture in a buffer that was dequeued.
  ImageView view(const v4l2_buffer& buffer) const;
  int buffers() const { return static_cast<int>(mappings_.size()); }
  int lent() const { return lent_.load(std::memory_order_relaxed); }
  const Device& device() const { return *device_; }
  const StreamFormat& format() const { return format_; }
  /// Tells how the device stamps its frames.
  uint32_t buffer_flags() const { return buffer_flags_; }

 private:
  struct Mapping {
    uint8_t* data = nullptr;
    size_t length = 0;
    int dmabuf = -1;
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
