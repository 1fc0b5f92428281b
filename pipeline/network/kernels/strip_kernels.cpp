#include "pipeline/network/kernels/strip_kernels.h"

#include <vector>

#include "common/cpu_features.h"
#include "pipeline/network/kernels/strip_kernels_by_isa.h"

namespace bevloc::nn {
namespace {

// These two functions are not in common/cpu_features.h, because clang-tidy reads every header and
// clang 14 does not know the name "avxvnni".
#ifdef __x86_64__
bool has_avx_vnni() {
  return __builtin_cpu_supports("avxvnni") != 0;
}
bool has_avx512_vnni() {
  return __builtin_cpu_supports("avx512vnni") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512vl") != 0;
}
#endif

std::vector<const KernelSet*> runnable_sets() {
  std::vector<const KernelSet*> sets;
#ifdef __x86_64__
  if (has_avx512_vnni()) sets.push_back(&kAvx512VnniKernels);
  if (has_avx_vnni()) sets.push_back(&kAvxVnniKernels);
  if (has_avx2()) sets.push_back(&kAvx2Kernels);
#endif
#ifdef __aarch64__
  if (has_i8mm()) sets.push_back(&kI8mmKernels);
  if (has_dot_product()) sets.push_back(&kDotProductKernels);
#endif
  sets.push_back(&kPlainKernels);
  return sets;
}

/// Whether the cap allows the set.
bool is_under([[maybe_unused]] const KernelSet& set, [[maybe_unused]] IsaCap cap) {
#ifdef __x86_64__
  if (&set == &kAvx512VnniKernels) return cap == IsaCap::kBest || cap == IsaCap::kAvx512Vnni;
  if (&set == &kAvxVnniKernels) return cap == IsaCap::kBest || cap == IsaCap::kAvx2Vnni;
#endif
  return true;
}

}  // namespace

std::span<const KernelSet* const> kernel_sets() {
  static const std::vector<const KernelSet*> sets = runnable_sets();
  return sets;
}

const KernelSet& kernel_set(IsaCap cap) {
  for (const KernelSet* set : kernel_sets()) {
    if (is_under(*set, cap)) return *set;
  }
  return kPlainKernels;
}

}  // namespace bevloc::nn
