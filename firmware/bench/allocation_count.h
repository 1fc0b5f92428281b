// How often the program has asked for memory. Linking this puts a counter before glibc's malloc.
#pragma once

#include <cstdint>

namespace bevloc::bench {

/// False where another allocator is in the way: under sanitizers, or without glibc.
bool allocations_are_counted();

/// Calls of malloc, calloc, realloc, memalign and their kin by all threads since the program
/// started, those of operator new and of shared libraries among them.
uint64_t allocation_count();

}  // namespace bevloc::bench
