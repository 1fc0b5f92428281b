// The conformance suite of Gpio: every implementation must pass it, mock or real.
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/clock/clock.h"
#include "tests/drivers/gpio_under_test.h"
#include "tests/support/open_descriptors.h"

namespace bevloc::drivers {
namespace {

using test::open_descriptors;

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;

class GpioConformance : public testing::TestWithParam<GpioImplementation> {
 protected:
  void SetUp() override {
    bench_ = GetParam().make();
    if (!bench_.refusal.empty()) FAIL() << bench_.refusal;
    if (!bench_.gpio) GTEST_SKIP() << GetParam().name << ": not available on this machine";
  }

  LineAddress address(const std::string& line, bool active_low = false) const {
    return {bench_.chip, line, active_low};
  }
  std::unique_ptr<OutputLine> output(const LineAddress& at, bool active) {
    auto line = bench_.gpio->open_output(at, active);
    EXPECT_TRUE(line) << line.error().message;
    return line ? std::move(*line) : nullptr;
  }
  std::unique_ptr<InputLine> input(const LineAddress& at) {
    auto line = bench_.gpio->open_input(at);
    EXPECT_TRUE(line) << line.error().message;
    return line ? std::move(*line) : nullptr;
  }

  GpioBench bench_;
};

TEST_P(GpioConformance, OutputDrivesTheWireFromTheStart) {
  for (const bool active_low : {false, true}) {
    for (const bool active : {false, true}) {
      const auto line = output(address("fault", active_low), active);
      ASSERT_TRUE(line);
      EXPECT_EQ(bench_.high("fault"), active != active_low);
      ASSERT_TRUE(line->set(!active));
      EXPECT_EQ(bench_.high("fault"), active == active_low);
      ASSERT_TRUE(line->set(active));
      EXPECT_EQ(bench_.high("fault"), active != active_low);
    }
  }
}

TEST_P(GpioConformance, InputReadsTheWire) {
  for (const bool active_low : {false, true}) {
    const auto line = input(address("ignition", active_low));
    ASSERT_TRUE(line);
    for (const bool high : {true, false, true}) {
      bench_.drive("ignition", high);
      const auto active = line->active();
      ASSERT_TRUE(active) << active.error().message;
      EXPECT_EQ(*active, high != active_low);
    }
  }
}

TEST_P(GpioConformance, EdgesComeInOrderWithTheirTimes) {
  MonotonicClock clock;
  for (const bool active_low : {false, true}) {
    bench_.drive("ignition", false);
    const auto line = input(address("ignition", active_low));
    ASSERT_TRUE(line);
    Time before = clock.now();
    for (const bool high : {true, false, true, false}) {
      bench_.drive("ignition", high);
      const auto edge = line->next_edge(seconds(10));
      ASSERT_TRUE(edge && *edge);
      EXPECT_EQ((*edge)->active, high != active_low);
      EXPECT_GE((*edge)->time, before);
      EXPECT_LE((*edge)->time, clock.now());
      before = (*edge)->time;
    }
  }
}

TEST_P(GpioConformance, AnEdgeIsKeptUntilItIsFetchedOnce) {
  bench_.drive("ignition", false);
  const auto line = input(address("ignition"));
  ASSERT_TRUE(line);
  bench_.drive("ignition", true);
  EXPECT_TRUE(line->active().value_or(false));
  const auto edge = line->next_edge(seconds(10));
  ASSERT_TRUE(edge && *edge);
  EXPECT_TRUE((*edge)->active);
  const auto another = line->next_edge(Duration::zero());
  ASSERT_TRUE(another);
  EXPECT_FALSE(*another);
}

TEST_P(GpioConformance, QuietLineTimesOut) {
  const auto line = input(address("ignition"));
  ASSERT_TRUE(line);
  for (const Duration timeout : {Duration::zero(), Duration(milliseconds(1))}) {
    const auto edge = line->next_edge(timeout);
    ASSERT_TRUE(edge) << edge.error().message;
    EXPECT_FALSE(*edge);
  }
}

TEST_P(GpioConformance, LineIsFoundByNumberToo) {
  const auto line = output(address("2"), true);
  ASSERT_TRUE(line);
  EXPECT_TRUE(bench_.high("fault"));
}

TEST_P(GpioConformance, LineInUseIsRefusedWithTheNameOfItsUser) {
  {
    const auto line = output(address("trigger"), false);
    const auto second = bench_.gpio->open_output(address("trigger"), false);
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message, AllOf(HasSubstr("trigger"), HasSubstr("\"bevloc\"")));
    EXPECT_FALSE(bench_.gpio->open_input(address("trigger")));
  }
  EXPECT_TRUE(bench_.gpio->open_output(address("trigger"), false));
}

TEST_P(GpioConformance, UnknownChipsAndLinesAreNamed) {
  const auto chip = bench_.gpio->open_output({"no-such-chip", "trigger"}, false);
  ASSERT_FALSE(chip);
  EXPECT_THAT(chip.error().message, AllOf(HasSubstr("no-such-chip"), HasSubstr(bench_.chip)));
  for (const char* line : {"no-such-line", "4", ""}) {
    const auto opened = bench_.gpio->open_input(address(line));
    ASSERT_FALSE(opened) << line;
    EXPECT_THAT(opened.error().message, HasSubstr("0 to 3"));
  }
}

TEST_P(GpioConformance, LinesOpenRepeatedlyAndLeakNoDescriptor) {
  const int before = open_descriptors();
  for (int round = 0; round < 3; ++round) {
    const auto out = output(address("trigger"), false);
    const auto in = input(address("ignition"));
    ASSERT_TRUE(out && in);
    EXPECT_TRUE(out->set(true));
  }
  EXPECT_EQ(open_descriptors(), before);
}

INSTANTIATE_TEST_SUITE_P(Gpios, GpioConformance, testing::ValuesIn(gpios_under_test()),
                         [](const auto& gpio) { return gpio.param.name; });

}  // namespace
}  // namespace bevloc::drivers
