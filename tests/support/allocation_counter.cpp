#include "tests/support/allocation_counter.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <dlfcn.h>

namespace {

constexpr int kMaxCallers = 100'000;
std::atomic<int> allocations{0};
std::atomic<bool> remembering{false};
std::atomic<int> caller_count{0};
std::array<void*, kMaxCallers> callers;

void* allocate(size_t size, size_t alignment, void* caller) noexcept {
  ++allocations;
  if (remembering) {
    const int i = caller_count++;
    if (i < kMaxCallers) callers[static_cast<size_t>(i)] = caller;
  }
  // aligned_alloc() wants a whole number of alignments, and something to allocate.
  const size_t rounded = (size + alignment) / alignment * alignment;
  return std::aligned_alloc(alignment, rounded);
}

void* or_throw(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

// All forms, because a sanitizer brings its own of those that are missing.
void* operator new(size_t size) {
  return or_throw(allocate(size, alignof(std::max_align_t), __builtin_return_address(0)));
}
void* operator new[](size_t size) {
  return or_throw(allocate(size, alignof(std::max_align_t), __builtin_return_address(0)));
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, alignof(std::max_align_t), __builtin_return_address(0));
}
void* operator new[](size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, alignof(std::max_align_t), __builtin_return_address(0));
}
void* operator new(size_t size, std::align_val_t alignment) {
  return or_throw(allocate(size, static_cast<size_t>(alignment), __builtin_return_address(0)));
}
void* operator new[](size_t size, std::align_val_t alignment) {
  return or_throw(allocate(size, static_cast<size_t>(alignment), __builtin_return_address(0)));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace bevloc::test {

int allocation_count() {
  return allocations;
}

AllocationCounter::AllocationCounter() {
  caller_count = 0;
  remembering = true;
}

AllocationCounter::~AllocationCounter() {
  remembering = false;
}

int AllocationCounter::outside_of(std::string_view library) {
  remembering = false;
  int outside = 0;
  for (int i = 0; i < std::min<int>(caller_count, kMaxCallers); ++i) {
    Dl_info info{};
    const bool found = dladdr(callers[static_cast<size_t>(i)], &info) != 0;
    const std::string_view path = found ? info.dli_fname : "";
    outside += !path.substr(path.rfind('/') + 1).starts_with(library);
  }
  return outside;
}

}  // namespace bevloc::test
