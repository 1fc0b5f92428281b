#include "evaluation/bench/allocation_count.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#include <dlfcn.h>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BEVLOC_COUNTS_MALLOC 1
#else
#define BEVLOC_COUNTS_MALLOC 0
#endif

namespace {

constexpr int kMaxCallers = 100'000;

std::atomic<uint64_t> allocations{0};
std::atomic<bool> recording{false};
std::atomic<int> caller_count{0};
std::array<void*, kMaxCallers> callers;

void count() {
  allocations.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

#if BEVLOC_COUNTS_MALLOC

// The program's malloc takes precedence over that of glibc, which stays available under these
// names. glibc's free() accepts the memory.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) noexcept {
  count();
  return __libc_malloc(size);
}

void* calloc(size_t number, size_t size) noexcept {
  count();
  return __libc_calloc(number, size);
}

void* realloc(void* memory, size_t size) noexcept {
  count();
  return __libc_realloc(memory, size);
}

void* memalign(size_t alignment, size_t size) noexcept {
  count();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(size_t alignment, size_t size) noexcept {
  return memalign(alignment, size);
}

int posix_memalign(void** memory, size_t alignment, size_t size) noexcept {
  const bool power_of_two = alignment != 0 && (alignment & (alignment - 1)) == 0;
  if (!power_of_two || alignment % sizeof(void*) != 0) return EINVAL;
  void* const made = memalign(alignment, size);
  if (made == nullptr) return ENOMEM;
  *memory = made;
  return 0;
}
}

#endif

namespace {

/// Memory for operator new. malloc counts the call if malloc is counted; else this function does.
void* allocate(size_t size, size_t alignment, void* caller) noexcept {
  if (BEVLOC_COUNTS_MALLOC == 0) count();
  if (recording) {
    const int i = caller_count++;
    if (i < kMaxCallers) callers[static_cast<size_t>(i)] = caller;
  }
  const size_t wanted = std::max<size_t>(size, 1);
  if (alignment <= alignof(std::max_align_t)) return std::malloc(wanted);
  // aligned_alloc() needs a multiple of the alignment.
  return std::aligned_alloc(alignment, (wanted + alignment - 1) / alignment * alignment);
}

void* or_throw(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

// All forms are replaced, because a sanitizer would provide its own for those that are missing.
void* operator new(size_t size) {
  return or_throw(allocate(size, 0, __builtin_return_address(0)));
}
void* operator new[](size_t size) {
  return or_throw(allocate(size, 0, __builtin_return_address(0)));
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, 0, __builtin_return_address(0));
}
void* operator new[](size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, 0, __builtin_return_address(0));
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

namespace bevloc::bench {

bool malloc_is_counted() {
  return BEVLOC_COUNTS_MALLOC == 1;
}

uint64_t allocation_count() {
  return allocations.load(std::memory_order_relaxed);
}

AllocationCallers::AllocationCallers() {
  caller_count = 0;
  recording = true;
}

AllocationCallers::~AllocationCallers() {
  recording = false;
}

int AllocationCallers::outside_of(std::string_view library) {
  recording = false;
  int outside = 0;
  for (int i = 0; i < std::min<int>(caller_count, kMaxCallers); ++i) {
    Dl_info info{};
    const bool found = dladdr(callers[static_cast<size_t>(i)], &info) != 0;
    const std::string_view path = found ? info.dli_fname : "";
    outside += !path.substr(path.rfind('/') + 1).starts_with(library);
  }
  return outside;
}

}  // namespace bevloc::bench
