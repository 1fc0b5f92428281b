// Which recordings are deleted for their age.
#include <fstream>

#include <gmock/gmock.h>

#include "firmware/recording/recording_ring.h"
#include "tests/firmware/log_capture.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::firmware {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Recordings of earlier runs. This one begins on the 1st of March 2040; files may be 7 days old.
class RecordingAgeTest : public testing::Test {
 protected:
  using Day = std::chrono::year_month_day;

  RecordingAgeTest() {
    config_.directory = folder_ / "ring";
    config_.max_age = std::chrono::hours(24 * 7);
    std::filesystem::create_directories(config_.directory);
  }

  /// A file whose name and whose time of the last change are of these days.
  std::filesystem::path leave(Day named, Day changed) const {
    const std::string name =
        fmt::format("bevloc-{:04}{:02}{:02}T000000Z-0001.mcap", static_cast<int>(named.year()),
                    static_cast<unsigned>(named.month()), static_cast<unsigned>(named.day()));
    const std::filesystem::path path = config_.directory / name;
    std::ofstream(path) << std::string(60'000, 'x');
    const std::chrono::sys_seconds time = std::chrono::sys_days(changed);
    std::filesystem::last_write_time(path, std::chrono::file_clock::from_sys(time));
    return path;
  }
  std::filesystem::path leave(Day day) const { return leave(day, day); }

  Result<RecordingRing> open() const {
    const Duration now = std::chrono::sys_days(kToday).time_since_epoch();
    return RecordingRing::open(config_, {}, static_cast<uint64_t>(now.count()));
  }

  static constexpr Day kToday{std::chrono::year(2040) / 3 / 1};
  static constexpr Day kEightDaysAgo{std::chrono::year(2040) / 2 / 22};
  static constexpr Day kSixDaysAgo{std::chrono::year(2040) / 2 / 24};
  static constexpr Day kUnset{std::chrono::year(1970) / 1 / 1};

  const test::TemporaryFolder folder_;
  RecordConfig config_;
};

TEST_F(RecordingAgeTest, AnOldFileIsDeletedAndTheLogSaysSo) {
  const auto old = leave(kEightDaysAgo);
  const auto young = leave(kSixDaysAgo);
  const auto future = leave(std::chrono::year(2050) / 1 / 1);
  const LogCapture log;
  ASSERT_TRUE(open());
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(young));
  EXPECT_TRUE(std::filesystem::exists(future));
  EXPECT_THAT(log.text(), HasSubstr("deleted 1 files"));
  EXPECT_THAT(log.text(), HasSubstr("record.max_age_h, 168 h"));
}

TEST_F(RecordingAgeTest, FilesOfAVehicleThatStoodForWeeksAreDeleted) {
  const auto old = leave(kEightDaysAgo);
  const auto older = leave(std::chrono::year(2040) / 1 / 1);
  ASSERT_TRUE(open());
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_FALSE(std::filesystem::exists(older));
}

TEST_F(RecordingAgeTest, AFileOfAnUnsetClockIsAsOldAsItsLastChange) {
  const auto changed = leave(kUnset, kSixDaysAgo);
  const auto old = leave(kEightDaysAgo);
  ASSERT_TRUE(open());
  EXPECT_TRUE(std::filesystem::exists(changed));
  EXPECT_FALSE(std::filesystem::exists(old));
}

TEST_F(RecordingAgeTest, ATimeOfTheLastChangeBeforeTheNameDoesNotCount) {
  const auto young = leave(kSixDaysAgo, kUnset);
  ASSERT_TRUE(open());
  EXPECT_TRUE(std::filesystem::exists(young)) << "the clock was set back during the drive";
}

TEST_F(RecordingAgeTest, AClockThatIsFarAheadDeletesNothingForItsAge) {
  const auto first = leave(std::chrono::year(2038) / 1 / 1);
  const auto second = leave(std::chrono::year(2038) / 1 / 2);
  const LogCapture log;
  auto ring = open();
  ASSERT_TRUE(ring) << ring.error().message;
  const Duration now = std::chrono::sys_days(kToday).time_since_epoch();
  for (int minute = 1; minute < 4; ++minute) {
    const Duration later = now + std::chrono::minutes(minute);
    ASSERT_TRUE(ring->step(static_cast<uint64_t>(later.count())));
  }
  EXPECT_TRUE(std::filesystem::exists(first));
  EXPECT_TRUE(std::filesystem::exists(second));
  const std::string text = log.text();
  const size_t warning = text.find("the clock is probably wrong");
  ASSERT_NE(warning, std::string::npos) << text;
  EXPECT_EQ(text.find("the clock is probably wrong", warning + 1), std::string::npos) << "once";
  EXPECT_THAT(text, Not(HasSubstr("deleted")));
}

TEST_F(RecordingAgeTest, AlsoThenTheSizeOfTheFolderIsBounded) {
  const auto first = leave(std::chrono::year(2038) / 1 / 1);
  const auto second = leave(std::chrono::year(2038) / 1 / 2);
  config_.max_bytes = 100'000;
  ASSERT_TRUE(open());
  EXPECT_FALSE(std::filesystem::exists(first));
  EXPECT_TRUE(std::filesystem::exists(second));
}

}  // namespace
}  // namespace bevloc::firmware
