// Counts the allocations of a test program, which thereby replaces operator new.
#pragma once

#include <string_view>

namespace bevloc::test {

/// How often `operator new` was called since the program started, in all threads.
int allocation_count();

/// Remembers who calls `operator new` from its construction on, in all threads. One at a time.
class AllocationCounter {
 public:
  AllocationCounter();
  ~AllocationCounter();

  /// Calls that do not come from the shared library whose file name begins with `library`.
  int outside_of(std::string_view library);
};

}  // namespace bevloc::test
