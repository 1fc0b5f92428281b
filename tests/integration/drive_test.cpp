// Drives with six mock cameras, judged by their result, their files and their CAN log.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <future>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "common/image_file.h"
#include "tests/can/e2e/independent_e2e.h"
#include "tests/integration/bevlocd_process.h"
#include "tests/support/demo_rig.h"
#include "tests/support/png_size.h"

namespace bevloc::test {
namespace {

const std::string kDemo = std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml";

nlohmann::json drive(const TemporaryFolder& scratch, const std::string& config,
                     const std::string& options) {
  const ProcessResult result =
      run_bevlocd("--config " + config + " --fast --out " + scratch.path().string() + " --json " +
                  (scratch / "result.json").string() + " " + options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(read_text(scratch / "result.json"));
}

E2eLogReport check_log(const std::filesystem::path& log) {
  std::ifstream log_file(log);
  return check_candump_log(log_file, load_dbc(std::string(BEVLOC_SOURCE_DIR) + "/can/bevloc.dbc"));
}

/// One drive, whose results several tests check.
class DriveTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new TemporaryFolder();
    result_ = new nlohmann::json(drive(*scratch_, kDemo, "--seed 901 --duration 10"));
  }
  static void TearDownTestSuite() {
    delete result_;
    delete scratch_;
  }

  static TemporaryFolder* scratch_;
  static nlohmann::json* result_;
};

TemporaryFolder* DriveTest::scratch_ = nullptr;
nlohmann::json* DriveTest::result_ = nullptr;

TEST_F(DriveTest, FindsThePoseAndBeatsThePrior) {
  const nlohmann::json& estimate = (*result_)["estimate"];
  const nlohmann::json& prior = (*result_)["prior"];
  EXPECT_LT((*result_)["first_fix_s"], 5.0);
  EXPECT_GT((*result_)["valid_share"], 0.9);
  EXPECT_LE((*result_)["valid_share"], 1.0);
  EXPECT_LT(estimate["longitudinal_m"]["mae"], 0.5);
  EXPECT_LT(estimate["lateral_m"]["mae"], 0.25);
  EXPECT_LT(estimate["yaw_deg"]["mae"], 0.6);
  const auto position_error = [](const nlohmann::json& error) {
    return double(error["longitudinal_m"]["mae"]) + double(error["lateral_m"]["mae"]);
  };
  EXPECT_LT(position_error(estimate), 0.6 * position_error(prior));
}

TEST_F(DriveTest, AccountsForEveryFrame) {
  const nlohmann::json& frames = (*result_)["frames"];
  EXPECT_EQ(uint64_t(frames["captured"]), uint64_t(frames["used"]) + uint64_t(frames["dropped"]));
  // Ten frames per second from six cameras for ten seconds; the last frameset may be under way.
  EXPECT_NEAR(double(frames["captured"]), 600.0, 12.0);
  EXPECT_LE(uint64_t(frames["dropped"]), 6U);
}

TEST_F(DriveTest, ReportsWhatItRan) {
  EXPECT_EQ((*result_)["seed"], 901);
  EXPECT_EQ((*result_)["duration_s"], 10.0);
  EXPECT_FALSE(std::string((*result_)["map"]).empty());
  EXPECT_FALSE(std::string((*result_)["model"]).empty());
  for (const char* side : {"prior", "estimate"}) {
    for (const char* axis : {"longitudinal_m", "lateral_m", "yaw_deg"}) {
      for (const char* measure : {"mae", "rmse", "p95"}) {
        EXPECT_GE(double((*result_)[side][axis][measure]), 0.0) << side << axis << measure;
      }
    }
  }
  EXPECT_GT(double((*result_)["latency_ms"]["p50"]), 0.0);
  EXPECT_LE(double((*result_)["latency_ms"]["p50"]), double((*result_)["latency_ms"]["p99"]));
}

TEST_F(DriveTest, EveryFrameOnTheBusPassesAnIndependentCheck) {
  const E2eLogReport report = check_log(*scratch_ / "can.log");
  EXPECT_EQ(report.unknown_frames, 0);
  EXPECT_EQ(report.unreadable_lines, 0);
  EXPECT_EQ(read_text(*scratch_ / "can.log").find("(-"), std::string::npos) << "a time before 0";
  EXPECT_EQ(report.by_message.size(), 16U) << "messages of the DBC file that occur";
  int localizer_frames = 0;
  for (const auto& [name, tally] : report.by_message) {
    EXPECT_TRUE(tally.is_clean()) << name;
    EXPECT_GT(tally.good, 0) << name;
    if (name.rfind("LOC_", 0) == 0) localizer_frames += tally.good;
  }
  EXPECT_EQ(localizer_frames, int((*result_)["can"]["sent"]));
}

TEST_F(DriveTest, LeavesACsvAndASheet) {
  const std::string csv = read_text(*scratch_ / "poses.csv");
  EXPECT_GT(std::count(csv.begin(), csv.end(), '\n'), 50);
  const SizePx size = png_size(read_text(*scratch_ / "sheet.png"));
  EXPECT_GT(size.width, 1000);
  RgbImage sheet(size.width, size.height);
  const Status read = read_image((*scratch_ / "sheet.png").string(), sheet);
  EXPECT_TRUE(read) << read.error().message;
}

TEST_F(DriveTest, TheSameSeedGivesTheSameLogByteForByte) {
  const TemporaryFolder again;
  drive(again, kDemo, "--seed 901 --duration 10");
  EXPECT_EQ(read_text(*scratch_ / "can.log"), read_text(again / "can.log"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // larger there
TEST_F(DriveTest, StaysWithin120MibWithItsWholeCity) {
  rusage children{};
  ASSERT_EQ(getrusage(RUSAGE_CHILDREN, &children), 0);
  EXPECT_LE(children.ru_maxrss, 120 * 1024) << "largest resident memory of a drive, KiB";
}
#endif

TEST(DriveVariantTest, AnotherSeedGivesAnotherLog) {
  const TemporaryFolder one;
  const TemporaryFolder other;
  drive(one, kDemo, "--seed 902 --duration 1");
  drive(other, kDemo, "--seed 903 --duration 1");
  EXPECT_NE(read_text(one / "can.log"), read_text(other / "can.log"));
}

TEST(RealTimeDriveTest, SigtermEndsADriveCleanly) {
  const TemporaryFolder scratch;
  const ProcessResult result =
      run_bevlocd("--config " + kDemo + " --duration 3600 --out " + scratch.path().string(),
                  "timeout --preserve-status --signal=TERM 3");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("CAN frames sent"), std::string::npos) << result.out;
}

TEST(DriveVariantTest, ADeadCameraDegradesTheState) {
  const TemporaryFolder scratch;
  write_file(scratch / "config.yaml",
             demo_config_with("  duration_s: 60\n",
                              "  duration_s: 60\n  faults:\n"
                              "    - {kind: camera_dead, camera: back_left, from_s: 5.0}\n"));
  const nlohmann::json result =
      drive(scratch, (scratch / "config.yaml").string(), "--seed 901 --duration 8");
  EXPECT_LT(double(result["frames"]["captured"]), 470.0);
  const std::string csv = read_text(scratch / "poses.csv");
  const size_t last_line = csv.rfind('\n', csv.size() - 2);
  EXPECT_NE(csv.find("DEGRADED", last_line), std::string::npos) << csv.substr(last_line);
  EXPECT_LT(double(result["estimate"]["lateral_m"]["mae"]), 0.4);
}

size_t count_of(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

/// Runs `bevloc fault`, again and again until the drive runs. Returns what it printed.
std::string fault_command(const TemporaryFolder& scratch, const std::string& command) {
  const std::string line = std::string(BEVLOC_PROGRAM) + " fault --socket " +
                           (scratch / "faults").string() + " " + command + " >" +
                           (scratch / "answer").string() + " 2>&1";
  for (int attempt = 0; attempt < 100; ++attempt) {
    const bool good = std::system(line.c_str()) == 0;
    const std::string answer = read_text(scratch / "answer");
    if (good || answer.find("no running drive") == std::string::npos) return answer;
  }
  return "the drive did not answer";
}

/// The longest time between two frames of an identifier in a candump log.
double longest_gap_s(const std::filesystem::path& log, const std::string& id) {
  std::ifstream lines(log);
  double last_s = -1.0;
  double longest_s = 0.0;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(" " + id + "#") == std::string::npos) continue;
    const double time_s = std::stod(line.substr(1));
    if (last_s >= 0.0) longest_s = std::max(longest_s, time_s - last_s);
    last_s = time_s;
  }
  return longest_s;
}

TEST(RealTimeDriveTest, FaultsAreSetAndClearedWhileTheDriveRuns) {
  const TemporaryFolder scratch;
  write_file(scratch / "config.yaml",
             demo_config_with("  duration_s: 60\n", "  duration_s: 60\n  fault_socket: " +
                                                        (scratch / "faults").string() + "\n"));
  auto run = std::async(std::launch::async, [&] {
    return run_bevlocd("--config " + (scratch / "config.yaml").string() + " --out " +
                       scratch.path().string() + " --seed 2901 --duration 10");
  });
  EXPECT_NE(fault_command(scratch, "set odometry_missing from_s=5 for_s=1").find("1: "),
            std::string::npos);
  EXPECT_NE(fault_command(scratch, "set gnss_outage from_s=1").find("2: gnss_outage"),
            std::string::npos);
  // The drive passes second 1, when the fault begins, during these two seconds.
  const auto began = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - began < std::chrono::seconds(2)) {
    EXPECT_NE(fault_command(scratch, "list").find("2: gnss_outage"), std::string::npos);
  }
  EXPECT_NE(fault_command(scratch, "set gnss_jump up_m=1").find("up_m"), std::string::npos);
  EXPECT_EQ(fault_command(scratch, "clear 2"), "");
  EXPECT_EQ(fault_command(scratch, "list").find("gnss_outage"), std::string::npos);
  EXPECT_EQ(run.get().exit_code, 0);
  EXPECT_NEAR(longest_gap_s(scratch / "can.log", "400"), 1.0, 0.2) << "odometry";
  const double gnss_gap_s = longest_gap_s(scratch / "can.log", "402");
  EXPECT_GT(gnss_gap_s, 0.15) << "GNSS was missing";
  EXPECT_LT(gnss_gap_s, 6.0) << "GNSS came back";
  EXPECT_FALSE(std::filesystem::exists(scratch / "faults"));
}

/// The demo with free-running cameras: no two cameras expose at the same time.
nlohmann::json unsynchronized_drive(bool compensate_motion) {
  const TemporaryFolder scratch;
  const std::string with_tolerance = demo_config_with(
      "  rate_hz: 10\n",
      std::string("  rate_hz: 10\n  tolerance_ms: 50\n  wait_ms: 100\n  compensate_motion: ") +
          (compensate_motion ? "true\n" : "false\n"));
  write_file(scratch / "config.yaml",
             replaced(with_tolerance, BEVLOC_SOURCE_DIR "/config/rig_demo.yaml",
                      (scratch / "rig.yaml").string()) +
                 "  exposure_offsets_ms: [0, 50, 20, 35, 10, 45]\n");
  write_file(scratch / "rig.yaml", format_rig(small_demo_rig(2)));
  nlohmann::json result =
      drive(scratch, (scratch / "config.yaml").string(), "--seed 901 --duration 10");
  const std::string csv = read_text(scratch / "poses.csv");
  // A refused match makes one pose DEGRADED. Cameras that are not synchronized make all poses
  // DEGRADED.
  const size_t tracking = count_of(csv, "TRACKING");
  const size_t degraded = count_of(csv, "DEGRADED");
  if (compensate_motion) {
    EXPECT_GT(tracking, 10 * degraded);
  } else {
    EXPECT_GT(degraded, 10 * tracking);
  }
  return result;
}

TEST(DriveVariantTest, MotionCompensationCorrectsForUnsynchronizedCameras) {
  const nlohmann::json with = unsynchronized_drive(true);
  const nlohmann::json without = unsynchronized_drive(false);
  EXPECT_EQ(with["frames"]["captured"], without["frames"]["captured"]);
  EXPECT_LE(uint64_t(with["frames"]["dropped"]), 6U) << "every frame is in a frameset";
  const auto mae = [](const nlohmann::json& result) {
    return double(result["estimate"]["longitudinal_m"]["mae"]) +
           double(result["estimate"]["lateral_m"]["mae"]);
  };
  EXPECT_LT(mae(with), 0.8 * mae(without));
}

}  // namespace
}  // namespace bevloc::test
