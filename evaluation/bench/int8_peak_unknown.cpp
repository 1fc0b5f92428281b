// Without oneDNN the int8 peak is unknown.
#include "evaluation/bench/int8_peak.h"

namespace bevloc::bench {

Int8Peak measure_int8_peak(int /*threads*/, const TimeOfRun& /*time_s*/) {
  return {};
}

std::string instruction_set() {
  return "unknown";
}

}  // namespace bevloc::bench
