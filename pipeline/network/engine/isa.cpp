#include "pipeline/network/engine/isa.h"

#include <mutex>
#include <optional>

#include <dnnl.hpp>

#ifdef __x86_64__
#include <cpuid.h>
#endif

#include "pipeline/network/model/load_error.h"

namespace bevloc::nn::onednn {
namespace {

constexpr uint32_t kAmxBits = 1U << 22 | 1U << 24 | 1U << 25;  // bf16, tile, int8
constexpr uint32_t kTileLeaf = 0x1D;

#if DNNL_VERSION_MAJOR >= 3
constexpr auto kNoCap = dnnl::cpu_isa::isa_default;
#else
constexpr auto kNoCap = dnnl::cpu_isa::all;
#endif

AmxCpuid read_cpuid() {
  AmxCpuid cpuid;
#ifdef __x86_64__
  uint32_t eax = 0;
  uint32_t ebx = 0;
  uint32_t ecx = 0;
  uint32_t edx = 0;
  cpuid.highest_leaf = __get_cpuid_max(0, nullptr);
  if (__get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx) != 0) cpuid.leaf7_edx = edx;
  if (__get_cpuid_count(kTileLeaf, 0, &eax, &ebx, &ecx, &edx) != 0) cpuid.palettes = eax;
#endif
  return cpuid;
}

dnnl::cpu_isa onednn_isa(IsaCap cap) {
  switch (cap) {
    case IsaCap::kBest:
      return amx_is_broken(read_cpuid()) ? dnnl::cpu_isa::avx512_core_bf16 : kNoCap;
    case IsaCap::kAvx512Vnni:
      return dnnl::cpu_isa::avx512_core_vnni;
    case IsaCap::kAvx512:
      return dnnl::cpu_isa::avx512_core;
    case IsaCap::kAvx2Vnni:
      return dnnl::cpu_isa::avx2_vnni;
    case IsaCap::kAvx2:
      return dnnl::cpu_isa::avx2;
  }
  return kNoCap;
}

}  // namespace

bool amx_is_broken(const AmxCpuid& cpuid) {
  const bool advertised = (cpuid.leaf7_edx & kAmxBits) != 0;
  return advertised && (cpuid.highest_leaf < kTileLeaf || cpuid.palettes == 0);
}

void cap_cpu_isa(IsaCap cap) {
  static std::mutex mutex;
  static std::optional<IsaCap> current;
  const std::lock_guard lock(mutex);
  if (current == cap) return;
  const dnnl::cpu_isa isa = onednn_isa(cap);
  // Without a cap there is nothing to set, so it does not matter whether another library has used
  // oneDNN before.
  const bool is_set =
      !current && (isa == kNoCap || dnnl::set_max_cpu_isa(isa) == dnnl::status::success);
  if (!is_set) {
    refuse("the instruction set of oneDNN is already fixed in this process, wanted another");
  }
  current = cap;
}

bool has_exact_int8_products() {
  const dnnl::cpu_isa isa = dnnl::get_effective_cpu_isa();
  return isa != dnnl::cpu_isa::sse41 && isa != dnnl::cpu_isa::avx && isa != dnnl::cpu_isa::avx2 &&
         isa != dnnl::cpu_isa::avx512_core;
}

}  // namespace bevloc::nn::onednn
