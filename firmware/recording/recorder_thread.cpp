#include "firmware/recording/recorder_thread.h"

#include "firmware/threads/realtime.h"

namespace bevloc::firmware {
namespace {

constexpr Duration kWritePeriod = std::chrono::milliseconds(20);

}  // namespace

std::jthread start_recording(Recorder& recorder, drivers::Clock& clock) {
  return std::jthread([&](const std::stop_token& stop) {
    begin_low_thread("recorder");
    while (!stop.stop_requested()) {
      clock.sleep_until(clock.now() + kWritePeriod);
      recorder.write_queued(clock.now());
    }
    recorder.finish(clock.now());
  });
}

}  // namespace bevloc::firmware
