#include "firmware/daemon/program.h"

#include <csignal>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "pipeline/calibration/rig_yaml.h"
#include "tests/firmware/log_capture.h"
#include "tests/support/demo_rig.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/turned_rig.h"

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

TEST(ProgramRigTest, IsThatOfTheFileAsItWasRead) {
  const test::TemporaryFolder folder;
  Config config;
  config.rig_file = folder / "rig.yaml";
  const auto missing = rig_of(config);
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, testing::StartsWith("calibration.rig: "));
  std::filesystem::copy_file(BEVLOC_SOURCE_DIR "/config/rig_demo.yaml", config.rig_file);
  config.kept_files.keep(config.rig_file);
  std::filesystem::remove(config.rig_file);
  const auto rig = rig_of(config);
  EXPECT_TRUE(rig) << rig.error().message;
}

TEST(ProgramRigTest, MustShowTheRoad) {
  const test::TemporaryFolder folder;
  Config config;
  config.rig_file = folder / "rig.yaml";
  const auto rig_with = [&](double down_deg) {
    EXPECT_TRUE(
        write_file(config.rig_file, format_rig(test::turned_down(test::demo_rig(), down_deg))));
    return rig_of(config);
  };
  const LogCapture log;
  EXPECT_TRUE(rig_with(0.0));
  EXPECT_EQ(log.text(), "");
  EXPECT_TRUE(rig_with(30.0));
  EXPECT_THAT(log.text(),
              testing::StartsWith("warning: calibration.rig: " + config.rig_file.string() +
                                  ": found cameras that show only a part"));
  const auto refused = rig_with(40.0);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              testing::StartsWith("calibration.rig: " + config.rig_file.string() +
                                  ": found cameras that show only a part"));
}

}  // namespace
}  // namespace bevloc::firmware
