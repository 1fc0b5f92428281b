#include "firmware/runtime/clock_watch.h"

#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/timex.h>

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

/// What the kernel says about its clock, asked without the code under test.
drivers::ClockDiscipline ask_kernel() {
  timex state{};
  const int answer = adjtimex(&state);
  if (answer < 0) return {};
  return {.synchronized = answer != TIME_ERROR && (state.status & STA_UNSYNC) == 0,
          .max_error = std::chrono::microseconds(state.maxerror)};
}

TEST(ClockWatchTest, AsksTheKernel) {
  const LogCapture log;
  // The kernel's bound never exceeds 16 s while its clock is synchronized.
  ClockWatch watch({.source = can::TimeSource::kNtp, .max_error = seconds(20)});
  const drivers::ClockDiscipline before = ask_kernel();
  const drivers::ClockDiscipline discipline = drivers::read_clock_discipline();
  const can::ClockReport report = watch.step();
  const drivers::ClockDiscipline after = ask_kernel();
  // A time service may change the bound at any time.
  const auto [least, most] = std::minmax({before.max_error, after.max_error});
  EXPECT_EQ(discipline.synchronized, before.synchronized);
  EXPECT_GE(discipline.max_error, least);
  EXPECT_LE(discipline.max_error, most);
  if (!before.synchronized) {
    EXPECT_EQ(report.source, can::TimeSource::kFreeRunning);
    EXPECT_EQ(lines_with(log, "not synchronized"), 1) << log.text();
    GTEST_SKIP() << "the rest needs a synchronized clock";
  }
  EXPECT_EQ(report.source, can::TimeSource::kNtp);
  EXPECT_GE(report.utc_error, least);
  EXPECT_LE(report.utc_error, most + milliseconds(5)) << "both clocks are read within 5 ms";
  EXPECT_GT(report.utc_offset, seconds(1'000'000'000));
}

}  // namespace
}  // namespace bevloc::firmware
