// Counts calls of operator new, by the library they come from.
#pragma once

#include <string_view>

namespace bevloc::test {

/// Counts from its construction on, in all threads. One at a time.
class AllocationCounter {
 public:
  AllocationCounter();
  ~AllocationCounter();

  /// Calls that do not come from the shared library whose file name begins with `library`.
  int outside_of(std::string_view library);
};

}  // namespace bevloc::test
