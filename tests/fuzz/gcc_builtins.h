// Lets clang compile the kernels for script/fuzz: stands in for what only GCC has. The fuzz targets
// read files and frames and never run a kernel.
#pragma once

#define __builtin_shuffle(a, b, order) (static_cast<void>(order), static_cast<void>(b), a)
#define __builtin_cpu_supports(name) false
