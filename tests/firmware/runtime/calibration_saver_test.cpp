#include "firmware/runtime/calibration_saver.h"

#include <filesystem>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "evaluation/bench/allocation_count.h"
#include "tests/firmware/log_capture.h"
#include "tests/firmware/stages/vision_stage_fixture.h"
#include "tests/pipeline/online_calibration/demo_driver.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::firmware {
namespace {

constexpr uint32_t kRig = 0x1234abcd;
constexpr Duration kPeriod = CalibrationSaver::kPeriod;
const ExtrinsicErrors kSmallError = error_of(1, 0, radians(0.3));
const ExtrinsicErrors kTurned = error_of(4, 0, radians(1.2));

class CalibrationSaverTest : public testing::Test {
 protected:
  /// Lets the vision thread see `time`, and the saver write what it then has.
  bool written_at(Time time) {
    saver_.note(time);
    return saver_.write_next(Duration::zero());
  }

  bool file_exists() const { return std::filesystem::exists(file_); }
  ExtrinsicErrors errors_in_file() const {
    const auto learned = load_learned(file_, kRig);
    EXPECT_TRUE(learned) << learned.error().message;
    return learned ? learned->errors : ExtrinsicErrors::Constant(-1.0);
  }
  const ExtrinsicErrors& errors() const { return driver_.calibration().filter().errors(); }

  int warnings() const {
    int count = 0;
    for (size_t at = 0; (at = log_.text().find("warning: ", at)) != std::string::npos; ++at) {
      ++count;
    }
    return count;
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "state/calibration.yaml";
  const LogCapture log_;
  DemoDriver driver_;
  CalibrationSaver saver_{driver_.calibration(), kRig, file_};
  const Time start_{std::chrono::seconds(100)};
};

TEST_F(CalibrationSaverTest, WritesOnceAMinuteWhatWasLearned) {
  std::filesystem::create_directory(file_.parent_path());
  EXPECT_FALSE(written_at(start_));
  driver_.drive(kSmallError, 40);
  EXPECT_FALSE(written_at(start_ + kPeriod - std::chrono::milliseconds(1)));
  EXPECT_FALSE(file_exists());
  EXPECT_TRUE(written_at(start_ + kPeriod));
  EXPECT_EQ(errors_in_file(), errors());

  const ExtrinsicErrors first = errors();
  driver_.drive(kSmallError, 40);
  EXPECT_FALSE(written_at(start_ + 2 * kPeriod - std::chrono::milliseconds(1)));
  EXPECT_EQ(errors_in_file(), first);
  EXPECT_TRUE(written_at(start_ + 2 * kPeriod));
  EXPECT_EQ(errors_in_file(), errors());
  EXPECT_NE(errors(), first);
}

TEST_F(CalibrationSaverTest, WritesNothingThatHasNotChanged) {
  std::filesystem::create_directory(file_.parent_path());
  EXPECT_FALSE(written_at(start_));
  EXPECT_FALSE(written_at(start_ + kPeriod)) << "nothing was learned yet";
  driver_.drive(kSmallError, 40);
  EXPECT_TRUE(written_at(start_ + 2 * kPeriod));
  std::filesystem::remove(file_);
  EXPECT_FALSE(written_at(start_ + 3 * kPeriod));
  saver_.finish();
  EXPECT_FALSE(file_exists());
}

TEST_F(CalibrationSaverTest, WritesNothingWhileACameraIsOutOfPlace) {
  std::filesystem::create_directory(file_.parent_path());
  EXPECT_FALSE(written_at(start_));
  driver_.drive(kTurned, 40);
  ASSERT_TRUE(driver_.calibration().faults().any());
  EXPECT_FALSE(written_at(start_ + kPeriod));
  saver_.finish();
  EXPECT_FALSE(file_exists());
}

TEST_F(CalibrationSaverTest, KeepsTheCalibrationOfTheStartWhenACameraIsFoundOutOfPlace) {
  std::filesystem::create_directory(file_.parent_path());
  EXPECT_FALSE(written_at(start_));
  const ExtrinsicErrors at_start = errors();
  driver_.drive(kTurned, 1);
  ASSERT_TRUE(driver_.calibration().faults().none()) << "it is not found yet";
  EXPECT_TRUE(written_at(start_ + kPeriod));
  EXPECT_NE(errors_in_file(), at_start);
  driver_.drive(kTurned, 40);
  ASSERT_TRUE(driver_.calibration().faults().any());
  EXPECT_TRUE(written_at(start_ + 2 * kPeriod));
  EXPECT_EQ(errors_in_file(), at_start);
  EXPECT_FALSE(written_at(start_ + 3 * kPeriod));
}

TEST_F(CalibrationSaverTest, AFailureIsLoggedOncePerCause) {
  EXPECT_FALSE(written_at(start_));
  driver_.drive(kSmallError, 40);
  for (int minute = 1; minute <= 3; ++minute) {
    EXPECT_FALSE(written_at(start_ + minute * kPeriod)) << "the folder does not exist";
  }
  EXPECT_EQ(warnings(), 1);
  EXPECT_NE(log_.text().find(file_.string()), std::string::npos) << log_.text();
  std::filesystem::create_directory(file_.parent_path());
  EXPECT_TRUE(written_at(start_ + 4 * kPeriod)) << "tries again, although nothing changed";
  std::filesystem::remove_all(file_.parent_path());
  driver_.drive(kSmallError, 40);
  EXPECT_FALSE(written_at(start_ + 5 * kPeriod));
  EXPECT_EQ(warnings(), 2);
}

TEST_F(CalibrationSaverTest, TheVisionThreadDoesNotAllocate) {
  saver_.note(start_);
  driver_.drive(kSmallError, 40);
  const uint64_t before = bench::allocation_count();
  for (int minute = 1; minute <= 3; ++minute) saver_.note(start_ + minute * kPeriod);
  EXPECT_EQ(bench::allocation_count(), before);
}

TEST_F(CalibrationSaverTest, TheThreadWritesWhileItRuns) {
  std::filesystem::create_directory(file_.parent_path());
  const std::jthread thread = start_saving(saver_);
  saver_.note(start_);
  driver_.drive(kSmallError, 40);
  saver_.note(start_ + kPeriod);
  while (!file_exists()) std::this_thread::yield();
  EXPECT_EQ(errors_in_file(), errors());
}

TEST_F(CalibrationSaverTest, TheThreadWritesTheLatestWhenItEnds) {
  std::filesystem::create_directory(file_.parent_path());
  std::jthread thread = start_saving(saver_);
  driver_.drive(kSmallError, 40);
  thread.request_stop();
  thread.join();
  EXPECT_EQ(errors_in_file(), errors());
}

using WatchedVisionTest = VisionStageImageTest;

TEST_F(WatchedVisionTest, AMatchHandsOverWhatWasLearnedBefore) {
  const test::TemporaryFolder folder;
  CalibrationSaver saver(*localizer_->online_calibration(), kRig, folder / "calibration.yaml");
  saver.watch(*stage_, clock_);
  const auto match = [&] {
    Prediction prediction;
    prediction.pose.time = clock_.now();
    predictions_.push(prediction);
    push_images(clock_.now(), true);
    const auto report = step();
    EXPECT_TRUE(report && report->had_prior);
  };
  match();
  ASSERT_TRUE(localizer_->restore_calibration(kSmallError, 1e-6 * ExtrinsicCovariance::Identity()));
  clock_.advance(kPeriod);
  EXPECT_FALSE(saver.write_next(Duration::zero()));
  match();
  EXPECT_TRUE(saver.write_next(Duration::zero()));
  EXPECT_EQ(load_learned(folder / "calibration.yaml", kRig)->errors, kSmallError);
}

TEST_F(WatchedVisionTest, NothingIsKeptWithoutAFileOrWithoutOnlineCalibration) {
  Config config;
  const Rig rig = sim::nominal_rig();
  EXPECT_FALSE(make_calibration_saver(config, rig, *localizer_));
  config.learned_calibration_file = "calibration.yaml";
  EXPECT_TRUE(make_calibration_saver(config, rig, *localizer_));
  LocalizerOptions options;
  options.online_calibration.enabled = false;
  const auto without = Localizer::create(
      rig, map_index_, std::string(BEVLOC_SOURCE_DIR) + "/models/nano.onnx", options);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_FALSE(make_calibration_saver(config, rig, **without));
}

}  // namespace
}  // namespace bevloc::firmware
