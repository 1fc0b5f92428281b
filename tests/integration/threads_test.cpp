// The daemon with all its threads, on the machine's own clock.
#include <filesystem>

#include <gtest/gtest.h>

#include "firmware/simulation/simulated_run.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::firmware {
namespace {

Config endless_demo() {
  auto config = load_config(std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml");
  EXPECT_TRUE(config) << config.error().message;
  config->simulation->duration_s = 3600.0;
  // A frame that is late by a period is given up: this leaves time enough under a sanitizer.
  config->cameras.rate_hz = 0.2;
  return *config;
}

SimulatedRunOptions quiet_options() {
  SimulatedRunOptions options;
  options.show_progress = false;
  options.out = std::filesystem::path(testing::TempDir()) / "bevloc-threads";
  return options;
}

TEST(ThreadsTest, RunsUntilItHasLocalizedAndJoinsEveryThread) {
  const Config config = endless_demo();
  const auto rig = read_rig(config.rig_file);
  ASSERT_TRUE(rig) << rig.error().message;
  const auto report = run_simulation(config, *rig, quiet_options(),
                                     [](const ApplianceView& view) { return view.cameras > 0; });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->frames.used, 0U);
  EXPECT_GE(report->frames.captured, report->frames.used);
  EXPECT_GT(report->can_sent, 0U);
}

TEST(ThreadsTest, StopsWhenAsked) {
  const Config config = endless_demo();
  const auto rig = read_rig(config.rig_file);
  ASSERT_TRUE(rig) << rig.error().message;
  int asked = 0;
  const auto report = run_simulation(config, *rig, quiet_options(),
                                     [&asked](const ApplianceView&) { return ++asked > 5; });
  EXPECT_TRUE(report) << report.error().message;
}

}  // namespace
}  // namespace bevloc::firmware
