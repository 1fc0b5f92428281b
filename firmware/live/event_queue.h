// The events of the live page, from the thread that draws to all viewers.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "common/time.h"

namespace bevloc::firmware {

/// Keeps the latest events. Each viewer reads them at its own pace. A viewer that is more than
/// kKept events behind continues with the newest one. Thread-safe.
class EventQueue {
 public:
  static constexpr size_t kKept = 32;
  using Event = std::shared_ptr<const std::string>;

  void push(std::string event) {
    {
      const std::lock_guard lock(mutex_);
      events_.push_back(std::make_shared<const std::string>(std::move(event)));
      if (events_.size() > kKept) events_.pop_front();
      ++pushed_;
    }
    filled_.notify_all();
  }

  /// Returns the number of the next event, with which a new viewer starts.
  uint64_t end() const {
    const std::lock_guard lock(mutex_);
    return pushed_;
  }

  /// Waits for the event number `next`. Returns it, or a newer one, and sets `next` to the number
  /// after it: `next` grows by more than one if events were skipped. Returns null after `timeout`
  /// or close().
  Event wait_for(uint64_t& next, Duration timeout) {
    std::unique_lock lock(mutex_);
    filled_.wait_for(lock, timeout, [&] { return closed_ || pushed_ > next; });
    if (closed_ || pushed_ <= next) return nullptr;
    const uint64_t oldest = pushed_ - events_.size();
    if (next < oldest) next = pushed_ - 1;
    return events_[next++ - oldest];
  }

  /// Wakes every viewer. They get no more events.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    filled_.notify_all();
  }
  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable filled_;
  std::deque<Event> events_;
  uint64_t pushed_ = 0;
  bool closed_ = false;
};

}  // namespace bevloc::firmware
