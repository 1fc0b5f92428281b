// The last seconds of what the tracker was told and what it made of it.
#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

#include "common/time.h"
#include "pipeline/tracker/motion_model.h"
#include "pipeline/tracker/pose_update.h"

namespace bevloc {

struct TrackerEvent {
  enum class Kind {
    kOdometry,  ///< `motion` is a sample
    kPose,      ///< `measurement` was accepted
    kWiden,     ///< the pose's covariance was raised
  };

  Time time;
  Kind kind = Kind::kOdometry;
  MeasuredMotion motion = {};        ///< at `time`, between samples by interpolation
  PoseMeasurement measurement = {};  ///< of kPose
  FilterState state = {};            ///< after the event
};

/// Events in the order of their time, in memory that is made once.
class EventHistory {
 public:
  explicit EventHistory(size_t capacity) : events_(capacity) { assert(capacity > 1); }

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == events_.size(); }

  TrackerEvent& operator[](size_t i) { return events_[slot(i)]; }
  const TrackerEvent& operator[](size_t i) const { return events_[slot(i)]; }
  const TrackerEvent& front() const { return (*this)[0]; }
  const TrackerEvent& back() const { return (*this)[size_ - 1]; }

  void clear() { size_ = 0; }

  void pop_front() {
    assert(!empty());
    first_ = (first_ + 1) % events_.size();
    --size_;
  }

  /// Puts `event` before the one at `position`; there must be room.
  void insert(size_t position, const TrackerEvent& event) {
    assert(!full() && position <= size_);
    ++size_;
    for (size_t i = size_ - 1; i > position; --i) (*this)[i] = (*this)[i - 1];
    (*this)[position] = event;
  }

  /// Number of events at or before `time`.
  size_t count_until(Time time) const {
    size_t count = size_;  // what is asked for is nearly always recent
    while (count > 0 && (*this)[count - 1].time > time) --count;
    return count;
  }

 private:
  size_t slot(size_t i) const {
    assert(i < size_);
    return (first_ + i) % events_.size();
  }

  std::vector<TrackerEvent> events_;
  size_t first_ = 0;
  size_t size_ = 0;
};

}  // namespace bevloc
