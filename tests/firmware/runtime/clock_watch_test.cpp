#include "firmware/runtime/clock_watch.h"

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/firmware/log_capture.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// What the kernel of the test says.
ClockWatch::Reading kernel_says;

ClockWatch::Reading read_of_test() {
  return kernel_says;
}

void say(bool synchronized, Duration max_error) {
  kernel_says = {{seconds(1'795'472'584), {synchronized, max_error, {}}}, Time(seconds(84))};
}

int lines_with(const LogCapture& log, const std::string& words) {
  std::istringstream lines(log.text());
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.find(words) != std::string::npos) ++count;
  }
  return count;
}

constexpr ClockConfig kPtp{.source = can::TimeSource::kPtp, .max_error = milliseconds(2)};

TEST(ClockWatchTest, TellsTheConfiguredSourceWhileTheKernelAgrees) {
  ClockWatch watch(kPtp, read_of_test);
  say(true, milliseconds(2));
  const can::ClockReport good = watch.step();
  EXPECT_EQ(good.source, can::TimeSource::kPtp);
  EXPECT_EQ(good.utc_offset, seconds(1'795'472'500));
  EXPECT_EQ(good.utc_error, milliseconds(2));
  say(true, milliseconds(2) + std::chrono::microseconds(1));
  EXPECT_EQ(watch.step().source, can::TimeSource::kFreeRunning);
  say(false, milliseconds(1));
  EXPECT_EQ(watch.step().source, can::TimeSource::kFreeRunning);
  say(true, milliseconds(1));
  EXPECT_EQ(watch.step().source, can::TimeSource::kPtp);
}

TEST(ClockWatchTest, ClaimsNothingThatIsNotConfigured) {
  ClockWatch watch({}, read_of_test);
  say(true, milliseconds(0));
  EXPECT_EQ(watch.step().source, can::TimeSource::kFreeRunning);
}

TEST(ClockWatchTest, LogsChanges) {
  const LogCapture log;
  ClockWatch watch(kPtp, read_of_test);
  say(false, seconds(16));
  watch.step();
  watch.step();
  EXPECT_EQ(lines_with(log, "not synchronized"), 1) << log.text();
  say(true, milliseconds(1));
  watch.step();
  watch.step();
  EXPECT_EQ(lines_with(log, "synchronized, error at most 1.000 ms"), 1) << log.text();
  say(true, milliseconds(3));
  watch.step();
  watch.step();
  EXPECT_EQ(lines_with(log, "found an error of up to 3.000 ms, wanted 2.000 ms"), 1) << log.text();
}

TEST(ClockWatchTest, LogsTheFirstLossOnce) {
  const LogCapture log;
  ClockWatch watch(kPtp, read_of_test);
  say(true, milliseconds(1));
  watch.step();
  say(false, seconds(16));
  watch.step();
  watch.step();
  EXPECT_EQ(lines_with(log, "not synchronized"), 1) << log.text();
}

TEST(ClockWatchTest, AsksTheKernel) {
  ClockWatch watch({.source = can::TimeSource::kNtp, .max_error = seconds(1)});
  const can::ClockReport report = watch.step();
  if (report.source == can::TimeSource::kFreeRunning) {
    GTEST_SKIP() << "the clock of this machine is not synchronized";
  }
  EXPECT_LE(report.utc_error, seconds(1));
  EXPECT_GT(report.utc_offset, seconds(1'000'000'000));
}

}  // namespace
}  // namespace bevloc::firmware
