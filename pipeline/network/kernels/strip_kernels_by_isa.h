// Declares the kernel sets. Each is defined in a file of its own.
#pragma once

#include "pipeline/network/kernels/strip_kernels.h"

namespace bevloc::nn {

extern const KernelSet kPlainKernels;
#ifdef __x86_64__
extern const KernelSet kAvx2Kernels;
extern const KernelSet kAvxVnniKernels;
extern const KernelSet kAvx512VnniKernels;
#endif
#ifdef __aarch64__
extern const KernelSet kDotProductKernels;
extern const KernelSet kI8mmKernels;
#endif

}  // namespace bevloc::nn
