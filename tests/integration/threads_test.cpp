// The daemon with all its threads, on the machine's own clock.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <sched.h>

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
  // So that the cameras of a frameset stay on display until the next one.
  config->health.correction_timeout = std::chrono::seconds(50);
  config->health.lost_timeout = std::chrono::seconds(60);
  return *config;
}

/// The demo's rig with an eighth of its resolution, which renders in no time.
Rig small_rig(const Config& config) {
  auto rig = read_rig(config.rig_file);
  EXPECT_TRUE(rig) << rig.error().message;
  for (CameraModel& camera : rig->cameras) {
    Intrinsics& intrinsics = camera.intrinsics;
    intrinsics.width_px /= 8;
    intrinsics.height_px /= 8;
    for (double* length :
         {&intrinsics.fx_px, &intrinsics.fy_px, &intrinsics.cx_px, &intrinsics.cy_px}) {
      *length /= 8.0;
    }
  }
  return *rig;
}

SimulatedRunOptions quiet_options() {
  SimulatedRunOptions options;
  options.show_progress = false;
  options.out = std::filesystem::path(testing::TempDir()) / "bevloc-threads";
  return options;
}

TEST(ThreadsTest, RunsUntilItHasLocalizedAndJoinsEveryThread) {
  const Config config = endless_demo();
  const auto report = run_simulation(config, small_rig(config), quiet_options(),
                                     [](const ApplianceView& view) { return view.cameras > 0; });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->frames.used, 0U);
  EXPECT_GE(report->frames.captured, report->frames.used);
  EXPECT_LE(report->frames.under_way(), uint64_t{kCameraCount}) << "each drop has its reason";
  EXPECT_GT(report->can_sent, 0U);
}

/// The CPUs on which each thread of this process may run, by its name.
std::map<std::string, int> cpus_by_thread() {
  std::map<std::string, int> cpus;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(thread.path() / "comm"), name);
    cpu_set_t set;
    CPU_ZERO(&set);
    sched_getaffinity(std::atoi(thread.path().filename().c_str()), sizeof set, &set);
    cpus[name] = CPU_COUNT(&set);
  }
  return cpus;
}

/// Of those that this thread may use.
int last_cpu() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  int last = CPU_SETSIZE - 1;
  while (!CPU_ISSET(static_cast<size_t>(last), &set)) --last;
  return last;
}

TEST(ThreadsTest, AreNamedAndRunWhereTheyAreTold) {
  Config config = endless_demo();
  config.realtime.vision.cpus = {last_cpu()};
  config.realtime.can.cpus = {last_cpu(), CPU_SETSIZE - 1};  // no machine has that many
  const int all = cpus_by_thread().begin()->second;
  std::map<std::string, int> cpus;
  int refusals = 0;
  const auto report =
      run_simulation(config, small_rig(config), quiet_options(), [&](const ApplianceView& view) {
        cpus = cpus_by_thread();
        refusals = view.realtime_refusals;
        return view.cameras > 0;  // every thread has had its turn
      });
  ASSERT_TRUE(report) << report.error().message;
  for (const std::string_view camera : kCameraNames) {
    EXPECT_EQ(cpus["cam-" + std::string(camera)], all) << camera;
  }
  EXPECT_EQ(cpus["vision"], 1);
  EXPECT_EQ(cpus["can-in"], 1);
  EXPECT_EQ(cpus["can-out"], 1);
  EXPECT_EQ(cpus["sim-judge"], all);
  EXPECT_EQ(refusals, 1);
  EXPECT_EQ(report->realtime_refusals, 1);
}

TEST(ThreadsTest, LockstepAsksTheKernelForNothing) {
  Config config = endless_demo();
  config.simulation->duration_s = 0.5;
  config.realtime.can.cpus = {CPU_SETSIZE - 1};
  SimulatedRunOptions options = quiet_options();
  options.fast = true;
  const auto report = run_simulation(config, small_rig(config), options,
                                     [](const ApplianceView&) { return false; });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->realtime_refusals, 0);
}

TEST(ThreadsTest, StopsWhenAsked) {
  const Config config = endless_demo();
  int asked = 0;
  const auto report = run_simulation(config, small_rig(config), quiet_options(),
                                     [&asked](const ApplianceView&) { return ++asked > 5; });
  EXPECT_TRUE(report) << report.error().message;
}

}  // namespace
}  // namespace bevloc::firmware
