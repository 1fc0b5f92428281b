#include "firmware/runtime/recorder_thread.h"

#include <sys/resource.h>
#include <unistd.h>

#include "firmware/runtime/realtime.h"

namespace bevloc::firmware {
namespace {

constexpr Duration kWritePeriod = std::chrono::milliseconds(20);
constexpr int kLowestPriority = 19;

}  // namespace

std::jthread start_recording(Recorder& recorder, drivers::Clock& clock) {
  return std::jthread([&](const std::stop_token& stop) {
    name_this_thread("recorder");
    // In Linux a priority belongs to a thread. A refusal only makes the thread less polite.
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kLowestPriority);
    while (!stop.stop_requested()) {
      clock.sleep_until(clock.now() + kWritePeriod);
      recorder.write_queued(clock.now());
    }
    recorder.finish(clock.now());
  });
}

}  // namespace bevloc::firmware
