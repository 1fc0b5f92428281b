// Whole short drives in lockstep: pictures from a cache, gaps of the clock, threads that hang.
#include "evaluation/drive/simulated_run.h"

#include <memory>
#include <sstream>

#include <gtest/gtest.h>

#include "sim/faults/fault_table.h"
#include "tests/support/demo_rig.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/text.h"

namespace bevloc::evaluation {
namespace {

using sim::FaultKind;
using sim::make_fault;

class SimulatedRunTest : public testing::Test {
 protected:
  void SetUp() override {
    auto config = load_drive_config(std::string(BEVLOC_SOURCE_DIR) + "/config/demo.yaml");
    ASSERT_TRUE(config) << config.error().message;
    config_ = *config;
    config_.simulation->seed = 2008;
    config_.simulation->town_seed = 2008;
    config_.simulation->duration_s = 3.0;
    options_.fast = true;
    options_.show_progress = false;
    options_.out = folder_.path();
    options_.pictures = shared_pictures();
  }

  /// The tests' drives see the same, so each picture is drawn once.
  static std::shared_ptr<drivers::PictureCache> shared_pictures() {
    static const auto kPictures = std::make_shared<drivers::PictureCache>();
    return kPictures;
  }

  Result<DriveReport> run() const {
    return run_simulation(config_, rig_, options_,
                          [](const firmware::ApplianceView&) { return false; });
  }
  std::string log() const { return test::read_text(options_.out / "can.log"); }

  DriveConfig config_;
  const Rig rig_ = test::small_demo_rig(2);
  const test::TemporaryFolder folder_;
  SimulatedRunOptions options_;
};

TEST_F(SimulatedRunTest, PicturesFromTheCacheGiveTheSameLog) {
  options_.pictures = nullptr;
  ASSERT_TRUE(run());
  const std::string without = log();
  options_.pictures = std::make_shared<drivers::PictureCache>();
  ASSERT_TRUE(run());
  EXPECT_EQ(log(), without);
  const auto first = options_.pictures->counters();
  EXPECT_GT(first.kept, 150U);
  EXPECT_EQ(first.found, 0U);
  config_.simulation->faults = {make_fault(FaultKind::kGnssOutage, 2.0)};
  ASSERT_TRUE(run());
  EXPECT_EQ(options_.pictures->counters().kept, first.kept) << "every picture was known";
  EXPECT_EQ(options_.pictures->counters().found, first.kept);
}

TEST_F(SimulatedRunTest, ASilentBusIsNotValid) {
  config_.simulation->duration_s = 6.0;
  config_.simulation->faults = {make_fault(FaultKind::kBusOff, 4.0)};
  const auto report = run();
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_GT(report->first_fix_s, 0.0);
  ASSERT_LT(report->first_fix_s, 4.0);
  EXPECT_NEAR(report->valid_share, (4.0 - report->first_fix_s) / (6.0 - report->first_fix_s), 0.02);
}

TEST_F(SimulatedRunTest, AGapOfTheClockIsAGapOnTheBus) {
  sim::Fault gap = make_fault(FaultKind::kClockGap, 1.0);
  gap.amounts.gap_s = 1.5;
  config_.simulation->faults = {gap};
  const auto report = run();
  ASSERT_TRUE(report) << report.error().message;
  // Each line of the log begins with "(seconds)". The drive begins at 0.5 s.
  std::istringstream lines(log());
  double last_s = 0.0;
  double largest_gap_s = 0.0;
  for (std::string line; std::getline(lines, line);) {
    const double time_s = std::stod(line.substr(1));
    largest_gap_s = std::max(largest_gap_s, time_s - last_s);
    last_s = time_s;
  }
  EXPECT_NEAR(largest_gap_s, 1.5, 0.02);
  EXPECT_NEAR(last_s, 3.5, 0.1);
}

TEST_F(SimulatedRunTest, AFullDiskIsNamed) {
  std::filesystem::create_symlink("/dev/full", options_.out / "can.log");
  config_.simulation->duration_s = 1.0;
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("can.log: found no room"), std::string::npos)
      << report.error().message;
}

TEST_F(SimulatedRunTest, AStoppedDriveIsNotTakenForAWholeOne) {
  config_.simulation->duration_s = 1.0;
  const auto whole = run();
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->driven_s, 1.0);
  EXPECT_EQ(to_table(*whole).find("stopped"), std::string::npos);
  int steps = 0;
  const auto part = run_simulation(
      config_, rig_, options_, [&steps](const firmware::ApplianceView&) { return ++steps == 10; });
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_GT(part->driven_s, 0.0);
  EXPECT_LT(part->driven_s, 0.9);
  EXPECT_NE(to_table(*part).find("s of 1.0 s"), std::string::npos);
}

/// Otherwise a reader would take the pictures of the earlier drive for those of the later one.
TEST_F(SimulatedRunTest, ThePictureFolderHoldsOneDrive) {
  options_.pictures_folder = folder_ / "pictures";
  const auto exists = [this](const char* name) {
    return std::filesystem::exists(options_.pictures_folder / name);
  };
  config_.simulation->duration_s = 2.0;
  ASSERT_TRUE(run());
  EXPECT_TRUE(exists("front/frames.txt"));
  EXPECT_TRUE(exists("map.bvm"));
  sim::Fault dead = make_fault(FaultKind::kCameraDead, -1.0);
  dead.camera = 1;
  config_.simulation->faults = {dead};
  const auto again = run();
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_FALSE(exists("front/frames.txt"));
  EXPECT_TRUE(exists("back/frames.txt"));
}

TEST_F(SimulatedRunTest, AThreadCannotHangInLockstep) {
  config_.simulation->faults = {make_fault(FaultKind::kHangVision, 1.0)};
  const auto report = run();
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("hang_vision"), std::string::npos);
}

}  // namespace
}  // namespace bevloc::evaluation
