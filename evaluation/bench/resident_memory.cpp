#include "evaluation/bench/resident_memory.h"

#include <fstream>
#include <string>

#include <malloc.h>

namespace bevloc::bench {

ResidentMemory resident_memory() {
  constexpr double kKib_per_mib = 1024.0;
  malloc_trim(0);
  ResidentMemory memory;
  std::ifstream file("/proc/self/status");
  for (std::string key; file >> key;) {
    double value_kib = 0.0;
    if (key == "VmRSS:" && file >> value_kib) memory.now_mib = value_kib / kKib_per_mib;
    if (key == "VmHWM:" && file >> value_kib) memory.peak_mib = value_kib / kKib_per_mib;
  }
  return memory;
}

}  // namespace bevloc::bench
