#include "evaluation/bench/timing.h"

#include <vector>

#include "drivers/clock/clock.h"

namespace bevloc::bench {

TimeSummary time_of(const std::function<void()>& run, int repeats) {
  const drivers::MonotonicClock clock;
  std::vector<double> times_ms;
  run();
  for (int i = 0; i < repeats; ++i) {
    const Time start = clock.now();
    run();
    times_ms.push_back(kMs_per_s * to_seconds(clock.now() - start));
  }
  return summarize(times_ms);
}

}  // namespace bevloc::bench
