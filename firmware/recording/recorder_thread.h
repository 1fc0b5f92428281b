// The thread that writes recordings.
#pragma once

#include <thread>

#include "drivers/clock/clock.h"
#include "firmware/recording/recorder.h"

namespace bevloc::firmware {

/// Writes what the recorder has queued, 50 times a second, with the lowest priority of the machine,
/// and ends the file when it is asked to stop. Nothing waits for this thread. Both must outlive it.
std::jthread start_recording(Recorder& recorder, drivers::Clock& clock);

}  // namespace bevloc::firmware
