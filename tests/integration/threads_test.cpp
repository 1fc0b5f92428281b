// The daemon with all its threads, on the machine's own clock.
#include <filesystem>

#include <gtest/gtest.h>

#include "firmware/simulation/simulated_run.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::firmware {
namespace {

Config short_demo() {
  auto config = load_config(std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml");
  EXPECT_TRUE(config) << config.error().message;
  config->simulation->duration_s = 3.0;
  config->cameras.rate_hz = 2.0;
  return *config;
}

SimulatedRunOptions quiet_options() {
  SimulatedRunOptions options;
  options.show_progress = false;
  options.out = std::filesystem::path(testing::TempDir()) / "bevloc-threads";
  return options;
}

TEST(ThreadsTest, RunsAndStopsWithEveryThreadJoined) {
  const Config config = short_demo();
  const auto rig = read_rig(config.rig_file);
  ASSERT_TRUE(rig) << rig.error().message;
  const auto report = run_simulation(config, *rig, quiet_options(), [] { return false; });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->frames.captured, 0U);
  EXPECT_GE(report->frames.captured, report->frames.used);
  EXPECT_GT(report->can_sent, 0U);
}

TEST(ThreadsTest, StopsWhenAsked) {
  Config config = short_demo();
  config.simulation->duration_s = 3600.0;
  const auto rig = read_rig(config.rig_file);
  ASSERT_TRUE(rig) << rig.error().message;
  int asked = 0;
  const auto report =
      run_simulation(config, *rig, quiet_options(), [&asked] { return ++asked > 5; });
  EXPECT_TRUE(report) << report.error().message;
}

}  // namespace
}  // namespace bevloc::firmware
