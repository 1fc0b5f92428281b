// Combines the frames of six cameras that belong to one moment into framesets.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <boost/circular_buffer.hpp>

#include "drivers/frameset/frameset.h"
#include "drivers/frameset/rate_monitor.h"
#include "drivers/frameset/split_monitor.h"

namespace bevloc::drivers {

struct SynchronizerConfig {
  /// Frames that are further apart do not belong to one frameset.
  Duration tolerance = std::chrono::milliseconds(2);
  /// How long a frameset waits for missing cameras, from the start of its earliest exposure. The
  /// wait ends earlier when the queue of any camera is full.
  Duration wait = std::chrono::milliseconds(60);
  /// A frameset with fewer cameras than this is dropped.
  int min_cameras = 3;

  bool operator==(const SynchronizerConfig&) const = default;
};

/// The result of add() for one frame. All but kAccepted are dropped.
enum class FrameFate : uint8_t {
  kAccepted,
  kDuplicate,   ///< same time as the camera's previous frame
  kOutOfOrder,  ///< older than the camera's previous frame
  kLate,        ///< its frameset was already emitted or dropped
  kFuture,      ///< its time is later than now: the camera's clock is wrong
};

/// The counters of one camera. Every added frame is either emitted, or still waiting, or counted in
/// exactly one of the summands of refused().
struct SynchronizerCounters {
  uint64_t added = 0;
  uint64_t emitted = 0;  ///< frames in an emitted frameset
  uint64_t duplicate = 0;
  uint64_t out_of_order = 0;
  uint64_t late = 0;
  uint64_t future = 0;
  uint64_t overflow = 0;    ///< dropped because the queue was full, as poll() was not called
  uint64_t unmatched = 0;   ///< dropped with a frameset that had too few cameras
  uint64_t missing = 0;     ///< framesets that were emitted without this camera
  uint64_t waited_for = 0;  ///< those of `missing` that waited for this camera until the end

  uint64_t refused() const {
    return duplicate + out_of_order + late + future + overflow + unmatched;
  }
};

/// Merges frames by time, driven by add() and poll(). It has no clock and no threads, so the same
/// calls give the same framesets. Frames are matched by time and not by sequence number, so a lost
/// frame cannot shift a camera against the others.
///
/// The earliest waiting frame opens a frameset. The earliest frame of each camera belongs to it if
/// it is within the tolerance. The frameset is emitted as soon as every camera has a frame in it or
/// a later frame, or when the wait is over, or when the queue of any camera is full: otherwise the
/// next frames would replace the frames that wait, and the wait would never end. A camera that was
/// missing from kPatience framesets in a row is not waited for until it delivers a frame again.
/// Only frames that may belong to a frameset (kAccepted or kLate) count as delivered, so that no
/// frameset waits for a camera whose clock is wrong.
///
/// Framesets are emitted in the order of time, and no frame is emitted twice. Allocates in its
/// constructor only. One thread.
class FramesetSynchronizer {
 public:
  /// Maximum number of waiting frames per camera.
  static constexpr int kQueueCapacity = 4;
  static constexpr int kPatience = 5;

  explicit FramesetSynchronizer(const SynchronizerConfig& config);

  /// `now` is the time of this call. A frame from the future is refused, because it would block its
  /// camera.
  FrameFate add(Frame frame, Time now);

  /// Returns the next frameset that is complete or has waited long enough at `now`. Call it until
  /// it returns nothing, after each add() or after adding all frames that have arrived.
  std::optional<Frameset> poll(Time now);

  /// Drops all waiting frames up to `time` and counts them as unmatched. Frames up to `time` that
  /// arrive later are late.
  void forget_until(Time time);

  /// Returns the time at which the open frameset stops waiting if no queue fills before, or nothing
  /// if no frame waits.
  std::optional<Time> deadline() const;

  /// Returns the cameras for which the open frameset waits, or none if no frame waits.
  CameraMask blockers() const;

  const SynchronizerCounters& counters(int camera) const { return cameras_[camera].counters; }
  /// Observes all framesets, also those that were dropped.
  const SplitMonitor& splits() const { return splits_; }
  /// Observes all accepted frames.
  const RateMonitor& rates() const { return rates_; }

 private:
  struct CameraQueue {
    boost::circular_buffer<Frame> frames{kQueueCapacity};  ///< waiting frames in the order of time
    Time newest = Time::min();  ///< time of the newest frame that was accepted or late
    int missed_in_a_row = 0;
    SynchronizerCounters counters;

    void push(Frame frame);
    Frame pop();
  };

  FrameFate judge(const CameraQueue& camera, Time time, Time now) const;
  std::optional<Time> opening_time() const;
  bool any_queue_full() const;
  CameraMask members(Time opening) const;
  Frameset emit(Time opening, CameraMask found, CameraMask waited_for);
  void discard(CameraMask found);

  const SynchronizerConfig config_;
  std::array<CameraQueue, kCameraCount> cameras_;
  Time closed_until_ = Time::min();  ///< frames up to this time belong to a past frameset
  SplitMonitor splits_;
  RateMonitor rates_;
};

}  // namespace bevloc::drivers
