// The requests and buffers of a libcamera camera, from one start() to its stop().
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <boost/circular_buffer.hpp>
#include <libcamera/libcamera.h>

#include "drivers/camera/device_camera.h"
#include "drivers/camera/frame_buffer.h"
#include "drivers/camera/libcamera/stream_format.h"

namespace bevloc::drivers::libcam {

/// A frame that is held keeps the memory of the session alive. stop() releases the camera itself.
/// libcamera completes requests in its own thread.
/// Thread-bound: called from the camera's own thread. A frame may be dropped by any thread.
class CaptureSession final : public FrameLender,
                             public std::enable_shared_from_this<CaptureSession> {
 public:
  static Result<std::shared_ptr<CaptureSession>> open(
      std::shared_ptr<libcamera::CameraManager> manager, const DeviceCameraConfig& config);
  ~CaptureSession() override;

  void stop();

  enum class Event : uint8_t { kCompleted, kTimeout, kDisconnected };
  /// Waits for a completed request. On kCompleted, `slot` is the one that completed first.
  Event wait(Duration timeout, int& slot);

  const libcamera::FrameMetadata& frame_metadata(int slot) const;
  /// Returns the time stamp that the pipeline passes on, if libcamera reports one (sensor_time.h).
  std::optional<int64_t> sensor_timestamp_ns(int slot) const;
  /// Returns the image in a completed request, with its bytes_used.
  ImageView view(int slot) const;

  FrameBuffer lend(int slot);
  /// Queues a request again. Thread-safe.
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

  // The order of destruction matters, because requests refer to buffers, and both refer to the
  // camera.
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
  boost::circular_buffer<int> completed_;  ///< slots in order of completion
  bool is_disconnected_ = false;
};

}  // namespace bevloc::drivers::libcam
