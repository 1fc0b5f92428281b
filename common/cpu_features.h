// Tests which instruction sets of the hand-written kernels this CPU has. There is no test for NEON,
// because every arm64 CPU has it.
#pragma once

#ifdef __aarch64__
#include <sys/auxv.h>
#endif

namespace bevloc {

#ifdef __x86_64__
inline bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0;
}
#endif

#ifdef __aarch64__
/// Dot products of signed bytes and of unsigned bytes (FEAT_DotProd, Armv8.2).
inline bool has_dot_product() {
  return (getauxval(AT_HWCAP) & HWCAP_ASIMDDP) != 0;
}
/// Dot products of signed with unsigned bytes (FEAT_I8MM, Armv8.6).
inline bool has_i8mm() {
  return (getauxval(AT_HWCAP2) & HWCAP2_I8MM) != 0;
}
#endif

}  // namespace bevloc
