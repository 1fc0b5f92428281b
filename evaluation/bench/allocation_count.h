// Counts the memory allocations of a program. A program that links this library replaces malloc and
// operator new.
#pragma once

#include <cstdint>
#include <string_view>

namespace bevloc::bench {

/// Whether allocation_count() includes malloc. False under a sanitizer or without glibc; only
/// operator new is counted there.
bool malloc_is_counted();

/// Number of calls of operator new, malloc, calloc, realloc, memalign and similar functions since
/// the program started, in all threads and all libraries.
uint64_t allocation_count();

/// Records the callers of operator new in all threads. At most one may exist at a time.
class AllocationCallers {
 public:
  AllocationCallers();
  ~AllocationCallers();

  /// Stops recording. Returns the number of calls that do not come from the shared library whose
  /// file name begins with `library`.
  int outside_of(std::string_view library);
};

}  // namespace bevloc::bench
