// Run-time choice of the instruction set for the renderer's pixel loops.
#pragma once

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
/// The loader picks the clone for the processor it runs on (ifunc; sanitizers cannot follow it).
#define BEVLOC_PIXEL_LOOP \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define BEVLOC_PIXEL_LOOP
#endif
