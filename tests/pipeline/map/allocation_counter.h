// Counts the allocations of a test program.
#pragma once

namespace bevloc {

/// How often `operator new` was called since the program started.
int allocation_count();

}  // namespace bevloc
