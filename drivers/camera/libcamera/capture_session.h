// A libcamera camera's requests and buffers while it runs, and after.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <libcamera/libcamera.h>

#include "drivers/camera/device_camera.h"
#include "drivers/camera/frame_buffer.h"
#include "drivers/camera/libcamera/stream_layout.h"

namespace bevloc::drivers::libcam {

/// From one start() to its stop(). Whoever holds a picture keeps the session's memory; the camera
/// itself is released by stop(). open(), wait(), lend() and stop() belong to one thread; libcamera
/// completes requests on a thread of its own.
class CaptureSession final : public FrameLender,
                             public std::enable_shared_from_this<CaptureSession> {
 public:
  static Result<std::shared_ptr<CaptureSession>> open(
      std::shared_ptr<libcamera::CameraManager> manager, const DeviceCameraConfig& config);
  ~CaptureSession() override;

  void stop();

  enum class Event : uint8_t { kCompleted, kTimeout, kDisconnected };
  /// On kCompleted, `slot` is the request that completed first.
  Event wait(Duration timeout, int& slot);

  const libcamera::FrameMetadata& frame_metadata(int slot) const;
  /// Start of exposure of the first row, as libcamera gives it; nothing where it does not.
  std::optional<int64_t> sensor_timestamp_ns(int slot) const;
  /// The picture; bytes_used is filled in.
  ImageView view(int slot) const;

  FrameBuffer lend(int slot);
  /// Back to the camera without having been lent. From any thread.
  void requeue(int slot) noexcept;

  int buffers() const { return static_cast<int>(requests_.size()); }
  int lent() const { return lent_.load(std::memory_order_relaxed); }

 private:
  struct Mapping {
    int dmabuf = -1;
    uint8_t* data = nullptr;
    size_t length = 0;
  };

  CaptureSession(std::shared_ptr<libcamera::CameraManager> manager,
                 std::shared_ptr<libcamera::Camera> camera)
      : manager_(std::move(manager)), camera_(std::move(camera)), allocator_(camera_) {}
  Status configure(const DeviceCameraConfig& config);
  Status make_requests();
  Status map(const libcamera::FrameBuffer& buffer);
  Status begin(const DeviceCameraConfig& config);
  void on_completed(libcamera::Request* request);
  void on_disconnected();
  void give_back(int slot) noexcept override;

  // In this order: requests refer to buffers, and both to the camera.
  const std::shared_ptr<libcamera::CameraManager> manager_;
  const std::shared_ptr<libcamera::Camera> camera_;
  bool is_acquired_ = false;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  libcamera::FrameBufferAllocator allocator_;
  libcamera::Stream* stream_ = nullptr;
  StreamLayout layout_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  std::vector<Mapping> mappings_;
  std::atomic<int> lent_{0};
  std::atomic<bool> running_{false};

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<int> completed_;  ///< slots, oldest first; never more than there are requests
  bool is_disconnected_ = false;
};

}  // namespace bevloc::drivers::libcam
