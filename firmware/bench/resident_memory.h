// What the kernel says of the memory of this process.
#pragma once

namespace bevloc::bench {

/// Of /proc/self/status, MiB; zero where there is none.
struct ResidentMemory {
  double now_mib = 0.0;   ///< VmRSS
  double peak_mib = 0.0;  ///< VmHWM
};

/// After giving back to the kernel what the heap holds unused.
ResidentMemory resident_memory();

}  // namespace bevloc::bench
