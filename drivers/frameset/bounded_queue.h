// Hands things from one thread to another; when the reader is slow, the newest win.
#pragma once

#include <cassert>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "common/time.h"

namespace bevloc::drivers {

/// Thread safe, for any number of writers and readers. A push into a full queue drops the oldest
/// entry and counts it; with capacity 1 it is a slot that holds the latest. All memory is made by
/// the constructor; the lock is held for one move of a T alone.
template <typename T>
class BoundedQueue {
 public:
  explicit BoundedQueue(size_t capacity) : entries_(capacity) { assert(capacity >= 1); }

  /// Never waits for a reader. Into a closed queue: the entry is dropped, uncounted.
  void push(T entry) {
    std::optional<T> oldest;  // dies outside the lock
    {
      const std::lock_guard lock(mutex_);
      if (closed_) return;
      if (size_ == entries_.size()) {
        oldest = take_first();
        ++dropped_;
      }
      entries_[(first_ + size_) % entries_.size()] = std::move(entry);
      ++size_;
    }
    not_empty_.notify_one();
  }

  /// The oldest entry; waits for one, `timeout` at most. Nothing on timeout, or when the queue is
  /// closed and empty. A timeout of zero only looks.
  std::optional<T> pop(Duration timeout) {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return size_ > 0 || closed_; };
    // An expired wait still gives the processor away.
    if (timeout > Duration::zero()) not_empty_.wait_for(lock, timeout, ready);
    if (size_ == 0) return std::nullopt;
    return take_first();
  }

  /// Wakes every reader; what is in the queue can still be fetched.
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

  /// Entries that nobody fetched.
  uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  /// The lock is held and the queue is not empty.
  std::optional<T> take_first() {
    std::optional<T> entry = std::exchange(entries_[first_], std::nullopt);
    first_ = (first_ + 1) % entries_.size();
    --size_;
    return entry;
  }

  mutable std::mutex mutex_;
  std::condition_variable not_empty_;
  std::vector<std::optional<T>> entries_;  ///< a ring
  size_t first_ = 0;
  size_t size_ = 0;
  uint64_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace bevloc::drivers
