// A value that one thread writes and any thread reads, without a lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace bevloc {

/// Holds the latest value that was stored (a sequence lock). store() is called from one thread and
/// never waits. The value is readable from any thread: load() tries again while a store is under
/// way. Both copy sizeof(T) bytes. Does not allocate.
template <typename T>
class Published {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Published() { store(T{}); }

  void store(const T& value) {
    std::array<uint64_t, kWords> copy{};
    std::memcpy(copy.data(), &value, sizeof(T));
    // The sequence is odd while the words change. A reader that sees a new word also sees the odd
    // number.
    const uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    for (size_t i = 0; i < kWords; ++i) words_[i].store(copy[i], std::memory_order_release);
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  T load() const {
    std::array<uint64_t, kWords> copy{};
    uint64_t before = 0;
    do {
      before = sequence_.load(std::memory_order_acquire);
      for (size_t i = 0; i < kWords; ++i) copy[i] = words_[i].load(std::memory_order_acquire);
    } while (before % 2 != 0 || before != sequence_.load(std::memory_order_relaxed));
    T value;
    std::memcpy(static_cast<void*>(&value), copy.data(), sizeof(T));
    return value;
  }

 private:
  static constexpr size_t kWords = (sizeof(T) + sizeof(uint64_t) - 1) / sizeof(uint64_t);

  std::atomic<uint64_t> sequence_{0};
  std::array<std::atomic<uint64_t>, kWords> words_{};
};

}  // namespace bevloc
