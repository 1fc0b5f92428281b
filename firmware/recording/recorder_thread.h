// The thread that writes recordings.
#pragma once

#include <thread>

#include "drivers/clock/clock.h"
#include "firmware/recording/recorder.h"

namespace bevloc::firmware {

/// Starts the thread. It writes what the recorder has queued, 50 times a second, with the lowest
/// priority of the normal scheduler. It ends the file when it is asked to stop. Nothing waits for
/// this thread. `recorder` and `clock` must outlive it.
std::jthread start_recording(Recorder& recorder, drivers::Clock& clock);

}  // namespace bevloc::firmware
