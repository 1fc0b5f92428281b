#include "firmware/bench/allocation_count.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BEVLOC_COUNTS_ALLOCATIONS 1
#else
#define BEVLOC_COUNTS_ALLOCATIONS 0
#endif

namespace {

// One relaxed addition for each allocation: nothing against what malloc itself does.
std::atomic<uint64_t> allocations{0};

}  // namespace

#if BEVLOC_COUNTS_ALLOCATIONS

// A program's own malloc goes before that of its libraries. glibc's stays there under these names,
// and its free() takes what they gave.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

void* calloc(size_t count, size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}

void* realloc(void* memory, size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(memory, size);
}

void* memalign(size_t alignment, size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
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

namespace bevloc::bench {

bool allocations_are_counted() {
  return BEVLOC_COUNTS_ALLOCATIONS == 1;
}

uint64_t allocation_count() {
  return allocations.load(std::memory_order_relaxed);
}

}  // namespace bevloc::bench
