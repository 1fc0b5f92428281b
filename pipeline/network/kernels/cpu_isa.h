// The caps on the CPU instructions that the network may use.
#pragma once

namespace bevloc {

/// The newest instruction set that the network may use. kBest sets no cap, so the network uses what
/// the CPU supports. There are caps on x86-64 only.
enum class IsaCap { kBest, kAvx512Vnni, kAvx512, kAvx2Vnni, kAvx2 };

}  // namespace bevloc
