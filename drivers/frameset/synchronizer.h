// Puts the frames of six cameras together that were taken at one time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drivers/frameset/frameset.h"
#include "drivers/frameset/rate_monitor.h"
#include "drivers/frameset/split_monitor.h"

namespace bevloc::drivers {

struct SynchronizerConfig {
  /// Frames further apart than this are not of one set.
  Duration tolerance = std::chrono::milliseconds(2);
  /// How long after the start of its earliest exposure a set waits for the cameras still missing.
  Duration wait = std::chrono::milliseconds(60);
  /// A set with fewer cameras than this is not given out.
  int min_cameras = 1;
};

/// What add() did with a frame.
enum class FrameFate : uint8_t {
  kAccepted,
  kDuplicate,   ///< same time as the camera's frame before
  kOutOfOrder,  ///< older than the camera's frame before
  kLate,        ///< its set has already been given out, or given up
  kFuture,      ///< taken later than now: the camera's clock is wrong
};

/// Of one camera. Every frame that was added is in a set, still waiting, or counted in exactly one
/// of duplicate, out_of_order, late, future, overflow and unmatched.
struct SynchronizerCounters {
  uint64_t added = 0;
  uint64_t emitted = 0;  ///< in a set
  uint64_t duplicate = 0;
  uint64_t out_of_order = 0;
  uint64_t late = 0;
  uint64_t future = 0;
  uint64_t overflow = 0;    ///< pushed out by newer ones because nobody polled
  uint64_t unmatched = 0;   ///< in a set with too few cameras
  uint64_t missing = 0;     ///< sets that were given out without this camera
  uint64_t waited_for = 0;  ///< of those, sets that waited for it in vain
};

/// A time-ordered merge, driven by add() and poll(); no clock, no threads, no allocation: the same
/// calls give the same sets. Matching is by time, never by sequence number, so that a lost frame
/// cannot shift a camera against the others.
///
/// The earliest waiting frame opens a set, to which each camera's earliest frame within the
/// tolerance belongs. The set is given out once every camera has either a frame in it or a later
/// one (then it has none for this set), or when the wait is over. A camera that has been missing
/// from kPatience sets in a row is not waited for until it sends again.
///
/// Sets come out in the order of time, no frame twice.
class FramesetSynchronizer {
 public:
  /// Waiting frames per camera.
  static constexpr int kQueueCapacity = 4;
  static constexpr int kPatience = 5;

  explicit FramesetSynchronizer(const SynchronizerConfig& config);

  /// `now` is the time of this call: a frame from the future would block its camera and is refused.
  FrameFate add(Frame frame, Time now);

  /// The next set that is complete or has waited long enough at `now`. To be called until there is
  /// none, after each add() or after all frames that have arrived.
  std::optional<Frameset> poll(Time now);

  /// When poll() will have something even if no frame arrives; nothing without a waiting frame.
  std::optional<Time> deadline() const;

  /// The cameras that the next set is waiting for (the blockers); none without a waiting frame.
  CameraMask blockers() const;

  const SynchronizerCounters& counters(int camera) const { return cameras_[camera].counters; }
  /// Over all sets, also those that were not given out.
  const SplitMonitor& splits() const { return splits_; }
  /// Over all frames that were accepted.
  const RateMonitor& rates() const { return rates_; }

 private:
  struct CameraQueue {
    std::array<Frame, kQueueCapacity> frames;  ///< a ring, in order of time
    int first = 0;
    int size = 0;
    Time newest = Time::min();  ///< of all that were accepted or late
    int missed_in_a_row = 0;
    SynchronizerCounters counters;

    const Frame& front() const { return frames[first]; }
    void push(Frame frame);
    Frame pop();
  };

  FrameFate judge(const CameraQueue& camera, Time time, Time now) const;
  std::optional<Time> opening_time() const;
  CameraMask members(Time opening) const;
  Frameset emit(Time opening, CameraMask found, CameraMask waited_for);
  void discard(CameraMask found);

  const SynchronizerConfig config_;
  std::array<CameraQueue, kCameraCount> cameras_;
  Time closed_until_ = Time::min();  ///< frames up to here belong to a set that is over
  SplitMonitor splits_;
  RateMonitor rates_;
};

}  // namespace bevloc::drivers
