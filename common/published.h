// A value that one thread writes and any thread reads, without a lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace bevloc {

/// Holds the latest value that was stored (a sequence lock). store() is called from one thread and
/// never waits. The value is readable from any thread: load() tries again while a store is under
/// way. All functions copy sizeof(T) bytes. Does not allocate.
///
/// A real-time thread reads a value of a thread of lower priority with try_load(). It may have
/// interrupted the store on its own processor. Then load() would never return, because the store
/// could not go on meanwhile.
template <typename T>
class Published {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Published() { store(T{}); }

  void store(const T& value) {
    std::array<uint64_t, kWords> copy{};
    std::memcpy(copy.data(), &value, sizeof(T));
    begin_store();
    for (size_t i = 0; i < kWords; ++i) words_[i].store(copy[i], std::memory_order_release);
    end_store();
  }

  T load() const {
    std::optional<T> value;
    while (!value) value = load_once();
    return *value;
  }

  /// Like load(), but returns nothing if a store is under way at each of kTries tries. A store on
  /// another processor ends sooner.
  std::optional<T> try_load() const {
    std::optional<T> value;
    for (int tries = 0; tries < kTries && !value; ++tries) value = load_once();
    return value;
  }

 protected:
  // The sequence is odd while the words change. A reader that sees a new word also sees the odd
  // number.
  void begin_store() {
    sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  void end_store() {
    sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

 private:
  static constexpr size_t kWords = (sizeof(T) + sizeof(uint64_t) - 1) / sizeof(uint64_t);
  static constexpr int kTries = 16;

  /// Returns nothing if a store was under way.
  std::optional<T> load_once() const {
    const uint64_t before = sequence_.load(std::memory_order_acquire);
    std::array<uint64_t, kWords> copy{};
    for (size_t i = 0; i < kWords; ++i) copy[i] = words_[i].load(std::memory_order_acquire);
    if (before % 2 != 0 || before != sequence_.load(std::memory_order_relaxed)) {
      return std::nullopt;
    }
    T value;
    std::memcpy(static_cast<void*>(&value), copy.data(), sizeof(T));
    return value;
  }

  std::atomic<uint64_t> sequence_{0};
  std::array<std::atomic<uint64_t>, kWords> words_{};
};

}  // namespace bevloc
