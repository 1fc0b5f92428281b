#include "firmware/runtime/program.h"

#include <csignal>

#include <gtest/gtest.h>

#include "tests/firmware/log_capture.h"

namespace bevloc::firmware {
namespace {

/// The order matters: a stop cannot be taken back.
TEST(ProgramSignalsTest, AHangupIsLoggedAndATerminationStops) {
  LogCapture log;
  handle_signals();
  EXPECT_FALSE(stop_requested());
  std::raise(SIGHUP);
  std::raise(SIGPIPE);
  EXPECT_FALSE(stop_requested());
  EXPECT_EQ(log.text(),
            "info: SIGHUP ignored: restart the service to read the configuration again\n");
  EXPECT_FALSE(stop_requested());
  std::raise(SIGTERM);
  EXPECT_TRUE(stop_requested());
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGPIPE}) std::signal(signal, SIG_DFL);
}

}  // namespace
}  // namespace bevloc::firmware
