// BEVLOC_TARGET_CLONES compiles a hot function for several instruction sets. The loader chooses one
// when the program starts. Sanitizers are not initialised at that moment, so their builds have one
// version only.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BEVLOC_TARGET_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define BEVLOC_TARGET_CLONES
#endif
