// Simulated drives with all threads, on the machine's clock.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <sched.h>

#include "evaluation/drive/simulated_run.h"
#include "sim/faults/fault_table.h"
#include "tests/support/demo_rig.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

const Rig kRig = test::small_demo_rig(8);

DriveConfig endless_demo() {
  auto config = load_drive_config(std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml");
  EXPECT_TRUE(config) << config.error().message;
  config->simulation->duration_s = 3600.0;
  // A mock camera drops a frame that is late by a period. A long period leaves enough time under a
  // sanitizer.
  config->cameras.rate_hz = 0.2;
  // Longer than the period, so that the cameras do not count as missing between two framesets.
  config->health.correction_timeout = std::chrono::seconds(50);
  config->health.lost_timeout = std::chrono::seconds(60);
  return *config;
}

SimulatedRunOptions quiet_options(const test::TemporaryFolder& folder) {
  SimulatedRunOptions options;
  options.show_progress = false;
  options.out = folder.path();
  return options;
}

TEST(RealTimeThreadsTest, RunsUntilItHasLocalizedAndEndsEveryThread) {
  const test::TemporaryFolder folder;
  const DriveConfig config = endless_demo();
  const auto report =
      run_simulation(config, kRig, quiet_options(folder),
                     [](const firmware::ApplianceView& view) { return view.cameras > 0; });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GT(report->frames.used, 0U);
  EXPECT_GE(report->frames.captured, report->frames.used);
  EXPECT_LE(report->frames.under_way(), uint64_t{kCameraCount})
      << "every other drop is counted with its reason";
  EXPECT_GT(report->can_sent, 0U);
}

/// The number of CPUs on which each thread of this process may run, by its name.
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

/// The last CPU that this thread may use.
int last_cpu() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  int last = CPU_SETSIZE - 1;
  while (!CPU_ISSET(static_cast<size_t>(last), &set)) --last;
  return last;
}

TEST(RealTimeThreadsTest, AreNamedAndRunOnTheConfiguredCpus) {
  const test::TemporaryFolder folder;
  DriveConfig config = endless_demo();
  config.realtime.vision.cpus = {last_cpu()};
  config.realtime.can.cpus = {last_cpu(), CPU_SETSIZE - 1};  // no machine has this CPU
  const int all = cpus_by_thread().begin()->second;
  std::map<std::string, int> cpus;
  int refusals = 0;
  const auto report =
      run_simulation(config, kRig, quiet_options(folder), [&](const firmware::ApplianceView& view) {
        cpus = cpus_by_thread();
        refusals = view.realtime_refusals;
        return view.cameras > 0;  // all threads have run
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

TEST(RealTimeThreadsTest, LockstepAppliesNoRealtimeSettings) {
  const test::TemporaryFolder folder;
  DriveConfig config = endless_demo();
  config.simulation->duration_s = 0.5;
  config.realtime.can.cpus = {CPU_SETSIZE - 1};
  SimulatedRunOptions options = quiet_options(folder);
  options.fast = true;
  const auto report =
      run_simulation(config, kRig, options, [](const firmware::ApplianceView&) { return false; });
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->realtime_refusals, 0);
}

/// A drive in which some threads hang from the start.
struct HangingDrive {
  WhyMask why;  ///< at the end
  DriveReport report;
};

/// Drives until the watchdog has said for a second that these threads hang, at most for a minute.
HangingDrive hanging_drive(sim::FaultKind kind, const std::string& threads) {
  constexpr int kSecond = 10;  // calls
  const test::TemporaryFolder folder;
  DriveConfig config = endless_demo();
  // The devices open before the drive begins, on a busy machine long before.
  config.simulation->faults.push_back(sim::make_fault(kind, -10.0));
  HangingDrive drive;
  int calls = 0;
  int hung_calls = 0;
  const auto report =
      run_simulation(config, kRig, quiet_options(folder), [&](const firmware::ApplianceView& view) {
        drive.why = view.why;
        hung_calls = view.hung.find(threads) != std::string::npos ? hung_calls + 1 : 0;
        return hung_calls == kSecond || ++calls == 60 * kSecond;
      });
  EXPECT_EQ(hung_calls, kSecond) << "these threads should hang: " << threads;
  EXPECT_TRUE(report) << report.error().message;
  if (report) drive.report = *report;
  EXPECT_LT(drive.report.first_fix_s, 0.0) << "without these threads no pose is valid";
  return drive;
}

TEST(HangingThreadsTest, CamerasStandStillAndEndWithTheRun) {
  const HangingDrive drive = hanging_drive(
      sim::FaultKind::kHangCapture, fmt::format("cam-{}", fmt::join(kCameraNames, ", cam-")));
  EXPECT_EQ(drive.report.frames.captured, 0U);
}

TEST(HangingThreadsTest, VisionStandsStillAndEndsWithTheRun) {
  const HangingDrive drive = hanging_drive(sim::FaultKind::kHangVision, "vision");
  EXPECT_GT(drive.report.frames.captured, 0U);
}

TEST(HangingThreadsTest, ReceivingStandsStillAndEndsWithTheRun) {
  const HangingDrive drive = hanging_drive(sim::FaultKind::kHangCanIn, "can-in");
  EXPECT_TRUE(drive.why.has(Why::kOdometryMissing));
  EXPECT_GT(drive.report.can_sent, 0U);
}

TEST(HangingThreadsTest, SendingStandsStillAndEndsWithTheRun) {
  const HangingDrive drive = hanging_drive(sim::FaultKind::kHangCanOut, "can-out");
  EXPECT_LE(drive.report.can_sent, 100U)
      << "the epoch that hung, and the sign-off; the daemon sends more than 1,000 in this time";
}

TEST(RealTimeThreadsTest, StopsWhenAsked) {
  const test::TemporaryFolder folder;
  const DriveConfig config = endless_demo();
  int asked = 0;
  const auto report =
      run_simulation(config, kRig, quiet_options(folder),
                     [&asked](const firmware::ApplianceView&) { return ++asked > 5; });
  EXPECT_TRUE(report) << report.error().message;
}

}  // namespace
}  // namespace bevloc::evaluation
