// BEVLOC_TARGET_CLONES before a hot function: compiled for several instruction sets, chosen when
// the program starts. Sanitizers run too late for that choice, so under them there is one version.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define BEVLOC_TARGET_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define BEVLOC_TARGET_CLONES
#endif
