// What this process uses of the machine.
#pragma once

namespace bevloc::firmware {

/// Memory and CPU time of this process, from the kernel.
struct ProcessUse {
  double resident_bytes = 0.0;
  double cpu_s = 0.0;
};

/// Asks the kernel. A value that it does not tell is zero.
ProcessUse use_of_this_process();

}  // namespace bevloc::firmware
