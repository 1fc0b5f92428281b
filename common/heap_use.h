// Measures how much heap memory the process uses.
#pragma once

#include <cstddef>

#include <malloc.h>

namespace bevloc {

/// Bytes that all threads have allocated now, as glibc counts them. The difference before and after
/// constructing an object is the memory of that object. The result is always 0 under a sanitizer,
/// because a sanitizer replaces the allocator.
inline size_t heap_in_use_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

}  // namespace bevloc
