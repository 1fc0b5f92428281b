// Memory between inaccessible pages, to detect reads out of bounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

namespace bevloc::test {

/// Accessing the byte after the last one ends the program; if `at_front`, accessing the byte before
/// the first one does.
class GuardedBytes {
 public:
  GuardedBytes(size_t size, bool at_front) : page_(static_cast<size_t>(sysconf(_SC_PAGESIZE))) {
    const size_t inner = (size + page_ - 1) / page_ * page_;
    mapped_ = inner + 2 * page_;
    map_ = mmap(nullptr, mapped_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    EXPECT_NE(map_, MAP_FAILED);
    auto* const begin = static_cast<uint8_t*>(map_) + page_;
    EXPECT_EQ(mprotect(begin, inner, PROT_READ | PROT_WRITE), 0);
    bytes_ = {at_front ? begin : begin + inner - size, size};
  }
  ~GuardedBytes() { munmap(map_, mapped_); }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;

  std::span<uint8_t> bytes() const { return bytes_; }

 private:
  size_t page_;
  size_t mapped_ = 0;
  void* map_ = nullptr;
  std::span<uint8_t> bytes_;
};

}  // namespace bevloc::test
