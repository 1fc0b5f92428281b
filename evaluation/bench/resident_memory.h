// The memory of this process, as the Linux kernel reports it.
#pragma once

namespace bevloc::bench {

/// From /proc/self/status, in MiB; 0 if that file is missing.
struct ResidentMemory {
  double now_mib = 0.0;   ///< VmRSS
  double peak_mib = 0.0;  ///< VmHWM
};

/// Returns unused heap memory to the kernel first.
ResidentMemory resident_memory();

}  // namespace bevloc::bench
