// Counts the allocations of a test program, which thereby replaces operator new.
#pragma once

namespace bevloc::test {

/// How often `operator new` was called since the program started, in all threads.
int allocation_count();

}  // namespace bevloc::test
