#include "firmware/daemon/program.h"

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

TEST(ProgramOptionsTest, RecordRawNeedsARecording) {
  ProgramOptions options;
  options.record_raw = true;
  Config config;
  const Status refused = override_config(options, config);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "--record-raw: found no recording, wanted --record DIR or the section record");
  options.record = "folder";
  ASSERT_TRUE(override_config(options, config));
  EXPECT_EQ(config.record->images, RecordedImages::kRaw);
}

}  // namespace
}  // namespace bevloc::firmware
