// The instruction sets that oneDNN may use.
#pragma once

#include <cstdint>

#include "pipeline/network/kernels/cpu_isa.h"

namespace bevloc::nn::onednn {

/// What CPUID reports about AMX.
struct AmxCpuid {
  uint32_t highest_leaf = 0;
  uint32_t leaf7_edx = 0;
  uint32_t palettes = 0;  ///< leaf 0x1D, subleaf 0, EAX
};

/// Some hypervisors advertise AMX but hide the CPUID leaf that describes its tiles. There, oneDNN
/// 2.6 executes an illegal instruction, so the engine must not use AMX.
bool amx_is_broken(const AmxCpuid& cpuid);

/// Sets the cap for the whole process. Must be called before the process creates its first oneDNN
/// primitive. Repeating the same cap has no effect; another cap throws LoadError. Thread-safe.
void cap_cpu_isa(IsaCap cap);

/// Whether oneDNN, under the current cap, sums int8 products without intermediate saturation (with
/// VNNI or AMX).
bool has_exact_int8_products();

}  // namespace bevloc::nn::onednn
