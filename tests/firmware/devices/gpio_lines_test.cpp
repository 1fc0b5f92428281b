#include "firmware/devices/gpio_lines.h"

#include <set>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/devices/fault_line.h"
#include "firmware/devices/status_led.h"
#include "firmware/runtime/trigger_thread.h"
#include "tests/firmware/log_capture.h"
#include "tests/support/mock_gpio.h"

namespace bevloc::firmware {
namespace {

using drivers::LineAddress;
using std::chrono::milliseconds;
using test::MockGpio;

constexpr Duration kDebounce = milliseconds(150);

/// A chip of which one output line fails.
class OneBrokenLine final : public drivers::Gpio {
 public:
  OneBrokenLine(drivers::Gpio& gpio, std::string line) : gpio_(gpio), broken_(std::move(line)) {}

  Result<std::unique_ptr<drivers::OutputLine>> open_output(const LineAddress& address,
                                                           bool active) override {
    if (address.line == broken_) return std::make_unique<Broken>();
    return gpio_.open_output(address, active);
  }
  Result<std::unique_ptr<drivers::InputLine>> open_input(const LineAddress& address) override {
    return gpio_.open_input(address);
  }

 private:
  class Broken final : public drivers::OutputLine {
   public:
    Status set(bool) override { return fail("mock line: no such device"); }
  };

  drivers::Gpio& gpio_;
  const std::string broken_;
};

const GpioConfig kLines{.trigger = {},
                        .status_led = LineAddress{MockGpio::kChip, "led"},
                        .fault = LineAddress{MockGpio::kChip, "fault", true},
                        .ignition = IgnitionConfig{{MockGpio::kChip, "ignition"}, kDebounce}};

class GpioLinesTest : public testing::Test {
 protected:
  GpioLinesTest() { gpio_.drive("ignition", true); }

  void open(const GpioConfig& config = kLines) { open(config, gpio_); }
  void open(const GpioConfig& config, drivers::Gpio& gpio) {
    auto lines = GpioLines::open(config, gpio, clock_.now());
    ASSERT_TRUE(lines) << lines.error().message;
    lines_ = std::move(*lines);
    auto fault = FaultLine::open(config.fault, gpio);
    ASSERT_TRUE(fault) << fault.error().message;
    fault_ = std::move(*fault);
  }

  bool step(bool lit = true, Duration after = milliseconds(100)) {
    clock_.advance(after);
    return lines_->step(lit, clock_.now());
  }

  bool fault() const { return !gpio_.high("fault"); }  // active low

  LogCapture log_;
  drivers::VirtualClock clock_{Time(milliseconds(1000))};
  MockGpio gpio_{{"led", "fault", "ignition"}, clock_};
  std::unique_ptr<GpioLines> lines_;
  std::unique_ptr<FaultLine> fault_;
};

TEST_F(GpioLinesTest, FaultIsActiveFromTheStartAndAfterTheEnd) {
  open();
  EXPECT_TRUE(fault());
  fault_->set(false, clock_.now());
  EXPECT_FALSE(fault());
  fault_.reset();
  EXPECT_TRUE(fault());
}

TEST_F(GpioLinesTest, TheLedIsOffAfterTheEnd) {
  open();
  step(true);
  EXPECT_TRUE(gpio_.high("led"));
  lines_.reset();
  EXPECT_FALSE(gpio_.high("led"));
}

TEST_F(GpioLinesTest, TheFaultLineIsDrivenAlthoughTheLedFails) {
  OneBrokenLine gpio(gpio_, "led");
  open(kLines, gpio);
  step();
  fault_->set(false, clock_.now());
  EXPECT_FALSE(fault());
  step();
  fault_->set(true, clock_.now());
  EXPECT_TRUE(fault());
}

TEST_F(GpioLinesTest, ALineThatFailsIsLoggedOncePerLine) {
  open();
  gpio_.unplug();
  for (int k = 0; k < 50; ++k) {
    EXPECT_TRUE(step()) << "a lost chip does not end localization";
    fault_->set(true, clock_.now());
  }
  EXPECT_THAT(log_.text(), testing::ContainsRegex("^warning: gpio: status LED: [^\n]*\n"
                                                  "warning: gpio: ignition: [^\n]*\n"
                                                  "error: gpio: fault line: [^\n]*\n$"));
}

TEST_F(GpioLinesTest, IgnitionIsOffAfterTheDebounceTime) {
  open();
  EXPECT_TRUE(step());
  gpio_.drive("ignition", false);
  EXPECT_TRUE(step(true, milliseconds(149)));
  EXPECT_FALSE(step(true, milliseconds(1)));
}

TEST_F(GpioLinesTest, AShortInterruptionOfTheIgnitionIsIgnored) {
  open();
  for (int k = 0; k < 30; ++k) {
    gpio_.drive("ignition", false);
    clock_.advance(milliseconds(20));
    gpio_.drive("ignition", true);
    EXPECT_TRUE(step());
  }
}

TEST_F(GpioLinesTest, IgnitionCanBeOffAtTheStartAndReturn) {
  gpio_.drive("ignition", false);
  open();
  EXPECT_FALSE(step());
  gpio_.drive("ignition", true);
  EXPECT_FALSE(step(true, milliseconds(149)));
  EXPECT_TRUE(step(true, milliseconds(1)));
}

TEST_F(GpioLinesTest, NoLinesAreNeeded) {
  open({});
  EXPECT_TRUE(step());
  fault_->set(true, clock_.now());
  EXPECT_TRUE(gpio_.changes("led").empty());
}

TEST_F(GpioLinesTest, NamesTheLineThatCannotBeOpened) {
  GpioConfig config = kLines;
  config.status_led->line = "lamp";
  const auto lines = GpioLines::open(config, gpio_, clock_.now());
  ASSERT_FALSE(lines);
  EXPECT_THAT(lines.error().message, testing::StartsWith("gpio: mock lamp: "));
}

TEST(TriggerThreadTest, AStoppedTriggerHasCountedEveryPulseOnTheLine) {
  drivers::MonotonicClock clock;
  MockGpio gpio({"trigger"}, clock);
  Realtime realtime{{}};
  // The period is long, so that a busy machine does not skip all pulses.
  const auto trigger = TriggerThread::start(
      {{MockGpio::kChip, "trigger"}, {milliseconds(100), milliseconds(1)}}, gpio, clock, realtime);
  ASSERT_TRUE(trigger) << trigger.error().message;
  const drivers::PulseLog& pulses = (*trigger)->trigger().pulses();
  while (pulses.count() < 2) std::this_thread::yield();
  EXPECT_GT((*trigger)->heartbeat().count(), 0U);
  (*trigger)->stop();
  EXPECT_TRUE((*trigger)->heartbeat().ended());
  EXPECT_EQ(gpio.changes("trigger").size(), 2 * pulses.count());
  EXPECT_FALSE(gpio.high("trigger"));
  (*trigger)->stop();
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

TEST(StatusLed, ShowsALossForASecond) {
  ShownState shown;
  Time now(milliseconds(100));
  EXPECT_EQ(shown.of(HealthState::kAcquiring, 0, now), HealthState::kAcquiring);
  EXPECT_EQ(shown.of(HealthState::kTracking, 0, now), HealthState::kTracking);
  for (int tenth = 0; tenth < 10; ++tenth, now += milliseconds(100)) {
    EXPECT_EQ(shown.of(HealthState::kAcquiring, 1, now), HealthState::kLost) << tenth;
    EXPECT_EQ(shown.of(HealthState::kFault, 1, now), HealthState::kFault) << tenth;
  }
  EXPECT_EQ(shown.of(HealthState::kAcquiring, 1, now), HealthState::kAcquiring);
}

}  // namespace
}  // namespace bevloc::firmware
