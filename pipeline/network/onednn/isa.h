// Which instructions oneDNN may use.
#pragma once

#include <cstdint>

#include "pipeline/network/cpu_isa.h"

namespace bevloc::nn::onednn {

/// What CPUID says of AMX.
struct AmxCpuid {
  uint32_t highest_leaf = 0;
  uint32_t leaf7_edx = 0;
  uint32_t palettes = 0;  ///< leaf 0x1D, subleaf 0, EAX
};

/// Some hypervisors advertise AMX but hide the leaf that describes its tiles. oneDNN 2.6 then runs
/// into an illegal instruction, so AMX may not be used there.
bool amx_is_broken(const AmxCpuid& cpuid);

/// Holds for the whole process, and only before its first oneDNN primitive. Asking again for the
/// same cap is fine; for another one it throws LoadError.
void cap_cpu_isa(IsaCap cap);

/// Whether oneDNN, under the cap, multiplies int8 without saturating in between (VNNI or AMX).
bool has_exact_int8_products();

}  // namespace bevloc::nn::onednn
