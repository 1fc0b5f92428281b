// A queue between threads that drops its oldest entry when it is full.
#pragma once

#include <atomic>
#include <cassert>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include <boost/circular_buffer.hpp>

#include "common/time.h"

namespace bevloc {

/// Thread-safe, for any number of writers and readers. A push into a full queue drops the oldest
/// entry and counts it, so a queue of capacity 1 holds the latest entry. The constructor allocates
/// all memory. The lock is held only while one T is moved. T must be movable.
template <typename T>
class BoundedQueue {
 public:
  explicit BoundedQueue(size_t capacity) : entries_(capacity) { assert(capacity >= 1); }

  /// Never waits for a reader. A closed queue drops the entry without counting it.
  void push(T entry) {
    std::optional<T> oldest;  // destroyed after the lock is released
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return;
      if (entries_.full()) {
        oldest = take_first();
        ++dropped_;
      }
      entries_.push_back(std::move(entry));
    }
    not_empty_.notify_one();
  }

  /// Returns the oldest entry and waits up to `timeout` for it. Returns nothing on timeout, or when
  /// the queue is closed and empty. A timeout of zero does not wait.
  std::optional<T> pop(Duration timeout) {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return !entries_.empty() || closed_; };
    // wait_for() gives up the processor even with a timeout of zero, so it is skipped then.
    if (timeout > Duration::zero()) not_empty_.wait_for(lock, timeout, ready);
    if (entries_.empty()) return std::nullopt;
    return take_first();
  }

  /// Wakes every reader. Entries in the queue can still be fetched.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    not_empty_.notify_all();
  }

  bool closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
  }

  /// Number of entries that were dropped before a reader fetched them.
  uint64_t dropped() const { return dropped_; }

 private:
  /// The caller holds the lock, and the queue is not empty.
  std::optional<T> take_first() {
    std::optional<T> entry(std::move(entries_.front()));
    entries_.pop_front();
    return entry;
  }

  mutable std::mutex mutex_;
  std::condition_variable not_empty_;
  boost::circular_buffer<T> entries_;
  std::atomic<uint64_t> dropped_{0};
  bool closed_ = false;
};

}  // namespace bevloc
