// How much of the heap the process uses.
#pragma once

#include <cstddef>

#include <malloc.h>

namespace bevloc {

/// Bytes that are allocated now, by all threads (glibc's own count). The difference across the
/// making of an object is what that holds. Always 0 under a sanitizer, which brings an allocator of
/// its own.
inline size_t heap_in_use_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

}  // namespace bevloc
