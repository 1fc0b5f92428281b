// Which instructions of the CPU the network may use.
#pragma once

namespace bevloc {

/// The newest instructions that the network may use; with kBest the CPU decides. Only engines that
/// compile their kernels at load can be capped.
enum class IsaCap { kBest, kAvx512Vnni, kAvx512, kAvx2Vnni, kAvx2 };

}  // namespace bevloc
