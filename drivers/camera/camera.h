// The interface of one camera, whatever stands behind it.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.h"
#include "common/time.h"
#include "drivers/camera/frame.h"

namespace bevloc::drivers {

/// What next_frame() came back with, when nothing is wrong.
enum class FrameEvent : uint8_t {
  kFrame,    ///< the frame has been filled in
  kTimeout,  ///< none came in time: the caller decides when a silent camera is a dead one
  kEnded,    ///< none will ever come (a recording is over)
};

/// Where a driver's frame times come from. Whatever it is, the driver converts: Frame::time is
/// always the start of exposure of the first row, on the steady clock.
enum class TimestampOrigin : uint8_t {
  kExposureStart,  ///< stamped at start of exposure
  kFrameEnd,       ///< stamped at end of frame, less read-out and exposure
  kSimulated,
  kRecorded,
};

struct CameraDescription {
  int camera = 0;  ///< index into kCameraNames
  int width_px = 0;
  int height_px = 0;
  int buffers = 0;  ///< pictures that the user may hold at one time
  TimestampOrigin timestamp_origin = TimestampOrigin::kExposureStart;
};

/// Since the camera was made.
struct CameraCounters {
  uint64_t delivered = 0;
  /// Lost because the user held every buffer.
  uint64_t no_buffer = 0;
  /// Lost because nobody fetched them before the next one was due.
  uint64_t overrun = 0;
  /// Lost before the driver: gaps in the device's own count that no missing buffer explains.
  uint64_t lost = 0;
  /// Arrived, but marked as bad by the device or not whole; dropped.
  uint64_t damaged = 0;
};

/// One camera. Every implementation passes tests/drivers/camera_conformance_test.cpp.
///
/// Threads: start(), next_frame() and stop() belong to one thread, the camera's own; counters() and
/// description() may be called from any. Frames may be dropped by any thread at any time, also
/// after stop() and after the camera is gone.
///
/// Memory: every picture is made by start() or before; a delivered frame allocates nothing.
///
/// Failure modes, and how each shows:
///   - device missing, busy, of wrong size:  start() fails; a later start() may succeed
///   - silent (cable, sensor hung):          next_frame() gives kTimeout, again and again
///   - unplugged, driver error, broken file: next_frame() fails; stop() and start() reconnect
///   - frame lost before the driver:         a gap in Frame::sequence
///   - user too slow:                        counted in no_buffer or overrun, and a gap in sequence
///   - frame late, twice, out of order:      delivered as it came; the frame synchronizer judges it
///   - picture frozen or dark:               not the driver's to see
class Camera {
 public:
  virtual ~Camera() = default;

  /// From now on frames arrive; sequence begins at 0. Fails when already started.
  virtual Status start() = 0;

  /// No more frames until the next start(). Frames that are held stay readable. Does nothing when
  /// not started.
  virtual void stop() = 0;

  /// Waits for the next frame, `timeout` at most; zero only looks whether there is one. A mock
  /// camera may take longer, by the time it needs to draw. On kFrame the old contents of `frame`
  /// are dropped.
  virtual Result<FrameEvent> next_frame(Duration timeout, Frame& frame) = 0;

  virtual CameraDescription description() const = 0;
  virtual CameraCounters counters() const = 0;
};

}  // namespace bevloc::drivers
