// Tests the daemon with replay cameras whose images cannot be read, and with mock GPIO lines.
#include "firmware/runtime/daemon.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "drivers/mock/mock_gpio.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc::firmware {
namespace {

using drivers::MockGpio;
using std::chrono::milliseconds;

const std::filesystem::path kSourceFolder = BEVLOC_SOURCE_DIR;
/// The daemon calls `stop` ten times per second. After this many calls the test fails.
constexpr int kMaxCalls = 300;

class DaemonTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::path(testing::TempDir()) / ("bevloc-daemon-" + name);
    for (const std::string_view camera : kCameraNames) {
      std::filesystem::create_directories(folder_ / camera);
      std::ofstream(folder_ / camera / "frames.txt") << "0 0 none.png\n";
      std::ofstream(folder_ / camera / "none.png") << "";
    }
    config_.cameras.driver = CameraDriver::kReplay;
    config_.cameras.recording = folder_;
    config_.map_file = kSourceFolder / "tests/pipeline/map/fixtures/street.osm";
    config_.model_file = kSourceFolder / "models/nano.onnx";
    config_.gpio.fault = drivers::LineAddress{MockGpio::kChip, "fault", true};
    config_.gpio.ignition = IgnitionConfig{{MockGpio::kChip, "ignition"}, milliseconds(50)};
    config_.gpio.trigger = TriggerLineConfig{{MockGpio::kChip, "trigger"}, {}};
    gpio_.drive("ignition", true);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Status run(const std::function<bool()>& stop) {
    const auto rig = read_rig(kSourceFolder / "config/rig_demo.yaml");
    EXPECT_TRUE(rig) << rig.error().message;
    return run_daemon(
        config_, *rig, gpio_, [this] { return wire_.connect(); }, stop);
  }

  std::filesystem::path folder_;
  Config config_;
  drivers::MonotonicClock clock_;
  MockGpio gpio_{{"trigger", "fault", "ignition"}, clock_};
  can::MockWire wire_{4096};
};

TEST_F(DaemonTest, EndsCleanlyWhenIgnitionGoesOff) {
  int calls = 0;
  bool fault_while_running = true;
  const Status status = run([&] {
    if (++calls == 3) {
      fault_while_running = !gpio_.high("fault");
      gpio_.drive("ignition", false);
    }
    return calls == kMaxCalls;
  });
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_LT(calls, kMaxCalls);
  EXPECT_FALSE(fault_while_running);
  EXPECT_FALSE(gpio_.high("fault")) << "active, which is low";
  EXPECT_FALSE(gpio_.high("trigger"));
  EXPECT_GE(gpio_.changes("trigger").size(), 2U);
  // All lines were released.
  EXPECT_TRUE(gpio_.open_input({MockGpio::kChip, "ignition"}));
}

TEST_F(DaemonTest, RunsWhileTheIgnitionIsOn) {
  int calls = 0;
  const Status status = run([&] { return ++calls == 5; });
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_EQ(calls, 5);
}

TEST_F(DaemonTest, DoesNotStartWithoutAConfiguredLine) {
  config_.gpio.ignition->address.line = "key";
  const Status status = run([] { return true; });
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, testing::StartsWith("gpio: mock key: "));
}

}  // namespace
}  // namespace bevloc::firmware
