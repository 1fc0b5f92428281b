#include "firmware/runtime/gpio_lines.h"

#include <set>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/mock/mock_gpio.h"
#include "firmware/runtime/status_led.h"

namespace bevloc::firmware {
namespace {

using drivers::LineAddress;
using drivers::MockGpio;
using std::chrono::milliseconds;

constexpr Duration kDebounce = milliseconds(150);

/// All lines but the trigger, whose thread cannot use the virtual clock of the test.
class GpioLinesTest : public testing::Test {
 protected:
  GpioLinesTest() { gpio_.drive("ignition", true); }

  static GpioConfig all_lines() {
    GpioConfig config;
    config.status_led = LineAddress{MockGpio::kChip, "led"};
    config.fault = LineAddress{MockGpio::kChip, "fault", true};
    config.ignition = IgnitionConfig{{MockGpio::kChip, "ignition"}, kDebounce};
    return config;
  }

  void open(const GpioConfig& config = all_lines()) {
    auto lines = GpioLines::open(config, gpio_, clock_, realtime_);
    ASSERT_TRUE(lines) << lines.error().message;
    lines_ = std::move(*lines);
  }

  bool step(HealthState state, Duration after = milliseconds(100)) {
    clock_.advance(after);
    ApplianceView view;
    view.state = state;
    return lines_->step(view, clock_.now());
  }

  bool fault() const { return !gpio_.high("fault"); }  // active low

  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  MockGpio gpio_{{"led", "fault", "ignition"}, clock_};
  Realtime realtime_{{}};
  std::unique_ptr<GpioLines> lines_;
};

TEST_F(GpioLinesTest, FaultIsActiveUntilTheStagesRunAndAfterTheEnd) {
  open();
  EXPECT_TRUE(fault());
  step(HealthState::kInit);
  EXPECT_FALSE(fault());
  step(HealthState::kLost);
  EXPECT_FALSE(fault());
  step(HealthState::kFault);
  EXPECT_TRUE(fault());
  step(HealthState::kTracking);
  EXPECT_FALSE(fault());
  EXPECT_TRUE(gpio_.high("led"));
  lines_.reset();
  EXPECT_TRUE(fault());
  EXPECT_FALSE(gpio_.high("led"));
}

TEST_F(GpioLinesTest, FaultIsActiveWhileAStageIsStalled) {
  open();
  ApplianceView view;
  view.state = HealthState::kTracking;
  view.stalled = true;
  lines_->step(view, clock_.now());
  EXPECT_TRUE(fault());
}

TEST_F(GpioLinesTest, IgnitionIsOffAfterTheDebounceTime) {
  open();
  EXPECT_TRUE(step(HealthState::kTracking));
  gpio_.drive("ignition", false);
  EXPECT_TRUE(step(HealthState::kTracking, milliseconds(149)));
  EXPECT_FALSE(step(HealthState::kTracking, milliseconds(1)));
}

TEST_F(GpioLinesTest, AShortInterruptionOfTheIgnitionIsIgnored) {
  open();
  for (int k = 0; k < 30; ++k) {
    gpio_.drive("ignition", false);
    clock_.advance(milliseconds(20));
    gpio_.drive("ignition", true);
    EXPECT_TRUE(step(HealthState::kTracking));
  }
}

TEST_F(GpioLinesTest, IgnitionThatIsOffAtTheStartEndsTheRun) {
  gpio_.drive("ignition", false);
  open();
  EXPECT_TRUE(step(HealthState::kInit));
  EXPECT_FALSE(step(HealthState::kInit));
}

TEST_F(GpioLinesTest, LostChipDoesNotEndLocalization) {
  open();
  gpio_.unplug();
  EXPECT_TRUE(step(HealthState::kTracking));
  EXPECT_TRUE(step(HealthState::kTracking));
}

TEST(GpioLinesTriggerTest, AStoppedTriggerHasCountedEveryPulseOnTheLine) {
  drivers::MonotonicClock clock;
  MockGpio gpio({"trigger"}, clock);
  Realtime realtime{{}};
  GpioConfig config;
  // The period is long, so that a busy machine does not skip all pulses.
  config.trigger = {{MockGpio::kChip, "trigger"}, {milliseconds(100), milliseconds(1)}};
  auto lines = GpioLines::open(config, gpio, clock, realtime);
  ASSERT_TRUE(lines) << lines.error().message;
  const drivers::PulseLog& pulses = (*lines)->trigger()->pulses();
  while (pulses.count() < 2) std::this_thread::yield();
  (*lines)->stop_trigger();
  EXPECT_EQ(gpio.changes("trigger").size(), 2 * pulses.count());
  EXPECT_FALSE(gpio.high("trigger"));
  (*lines)->stop_trigger();
}

TEST_F(GpioLinesTest, NoLinesAreNeeded) {
  open({});
  lines_->stop_trigger();
  EXPECT_TRUE(step(HealthState::kTracking));
  EXPECT_EQ(lines_->trigger(), nullptr);
  EXPECT_TRUE(gpio_.changes("led").empty());
}

TEST_F(GpioLinesTest, NamesTheLineThatCannotBeOpened) {
  GpioConfig config = all_lines();
  config.status_led->line = "lamp";
  const auto lines = GpioLines::open(config, gpio_, clock_, realtime_);
  ASSERT_FALSE(lines);
  EXPECT_THAT(lines.error().message, testing::StartsWith("gpio: mock lamp: "));
  EXPECT_TRUE(fault()) << "the appliance did not start";
}

TEST(StatusLed, ShowsEachStateDifferently) {
  std::set<std::string> seen;
  for (const HealthState state :
       {HealthState::kInit, HealthState::kAcquiring, HealthState::kTracking, HealthState::kDegraded,
        HealthState::kLost, HealthState::kFault}) {
    std::string shown;
    for (int slot = 0; slot < 20; ++slot) {
      shown += is_lit(state, Time(milliseconds(100 * slot + 50))) ? '#' : '-';
    }
    EXPECT_TRUE(seen.insert(shown).second) << shown;
  }
  EXPECT_TRUE(seen.contains("####################"));
}

}  // namespace
}  // namespace bevloc::firmware
