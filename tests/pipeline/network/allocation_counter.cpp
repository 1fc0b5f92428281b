#include "tests/pipeline/network/allocation_counter.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <dlfcn.h>

namespace bevloc::test {
namespace {

constexpr int kMaxCallers = 100'000;
std::atomic<bool> counting = false;
std::atomic<int> caller_count = 0;
std::array<void*, kMaxCallers> callers;

void* allocate(size_t bytes, size_t alignment, void* caller) {
  if (counting) {
    const int i = caller_count++;
    if (i < kMaxCallers) callers[static_cast<size_t>(i)] = caller;
  }
  const size_t rounded = (bytes + alignment) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, rounded);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

AllocationCounter::AllocationCounter() {
  caller_count = 0;
  counting = true;
}

AllocationCounter::~AllocationCounter() {
  counting = false;
}

int AllocationCounter::outside_of(std::string_view library) {
  counting = false;
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

void* operator new(size_t bytes) {
  return bevloc::test::allocate(bytes, alignof(std::max_align_t), __builtin_return_address(0));
}
void* operator new[](size_t bytes) {
  return bevloc::test::allocate(bytes, alignof(std::max_align_t), __builtin_return_address(0));
}
void* operator new(size_t bytes, std::align_val_t alignment) {
  return bevloc::test::allocate(bytes, static_cast<size_t>(alignment), __builtin_return_address(0));
}
void* operator new[](size_t bytes, std::align_val_t alignment) {
  return bevloc::test::allocate(bytes, static_cast<size_t>(alignment), __builtin_return_address(0));
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
