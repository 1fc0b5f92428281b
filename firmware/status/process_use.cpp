#include "firmware/status/process_use.h"

#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

namespace bevloc::firmware {

ProcessUse use_of_this_process() {
  ProcessUse use;
  std::ifstream statm("/proc/self/statm");
  double total_pages = 0.0;
  double resident_pages = 0.0;
  if (statm >> total_pages >> resident_pages) {
    use.resident_bytes = resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE));
  }
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    use.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return use;
}

}  // namespace bevloc::firmware
