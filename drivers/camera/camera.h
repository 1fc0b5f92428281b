// The interface of a camera, mock or real.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.h"
#include "common/time.h"
#include "drivers/camera/frame.h"

namespace bevloc::drivers {

/// Number of frame buffers per camera, unless the configuration gives another one.
inline constexpr int kDefaultFrameBuffers = 4;

/// The result of next_frame() when there is no error.
enum class FrameEvent : uint8_t {
  kFrame,    ///< the frame was filled in
  kTimeout,  ///< no frame came in time; the caller decides when a silent camera counts as dead
  kEnded,    ///< no frame will come any more, as at the end of a picture folder
};

struct CameraDescription {
  int camera = 0;  ///< index into kCameraNames
  int width_px = 0;
  int height_px = 0;
  int buffers = 0;  ///< number of frames that the user may hold at the same time
  /// Whether the configured readout time is not used, because the device's driver says that it
  /// stamps the start of exposure. A V4L2 camera sets this value in start().
  bool ignores_readout = false;
};

/// Numbers of frames since the camera object was constructed.
struct CameraCounters {
  uint64_t delivered = 0;
  /// Frames that were lost because the user held all buffers.
  uint64_t no_buffer = 0;
  /// Frames that were lost because they were not fetched before the next frame was due.
  uint64_t overrun = 0;
  /// Frames that were lost before they reached the driver: gaps in the device's sequence while a
  /// buffer was free.
  uint64_t lost = 0;
  /// Frames that were dropped because the device marked them as bad, or because they were
  /// incomplete.
  uint64_t damaged = 0;

  /// Frames that the camera took and the user did not get.
  uint64_t missed() const { return no_buffer + overrun + lost + damaged; }
};

/// One camera. Every implementation passes tests/drivers/camera_conformance_test.cpp.
///
/// Thread-bound: start(), next_frame() and stop() are called from the camera's own thread.
/// counters() and description() are readable from any thread. Any thread may drop a frame at any
/// time, also after stop() and after the camera is destroyed.
///
/// Memory: buffers are allocated by start() or before. Delivering a frame does not allocate.
///
/// Failure modes:
///   - device missing, busy, of wrong size:  start() fails; a later start() may succeed
///   - silent (cable, sensor hangs):         next_frame() returns kTimeout every time
///   - unplugged, driver error, broken file: next_frame() fails; stop() and start() reconnect
///   - frame lost before the driver:         a gap in Frame::sequence
///   - user too slow:                        counted in no_buffer or overrun, and a gap in sequence
///   - frame late, twice or out of order:    delivered unchanged; FramesetSynchronizer refuses it
///   - image frozen or dark:                 the driver does not detect it
class Camera {
 public:
  virtual ~Camera() = default;

  /// Starts the camera. The sequence begins at 0. Fails when the camera is already started.
  virtual Status start() = 0;

  /// Stops the camera. Frames that are held stay readable. Does nothing when the camera is not
  /// started.
  virtual void stop() = 0;

  /// Waits up to `timeout` for the next frame. With a timeout of zero it does not wait. A mock
  /// camera may wait longer: until it has drawn the image. On kFrame, `frame` is replaced.
  virtual Result<FrameEvent> next_frame(Duration timeout, Frame& frame) = 0;

  virtual CameraDescription description() const = 0;
  virtual CameraCounters counters() const = 0;
};

}  // namespace bevloc::drivers
