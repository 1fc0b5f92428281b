// Tests the daemon with replay cameras whose images cannot be read, and with mock GPIO lines.
#include "firmware/daemon/daemon.h"

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "can/bus/mock_bus.h"
#include "common/crc32.h"
#include "common/files.h"
#include "common/sha256.h"
#include "firmware/live/http_server.h"
#include "firmware/live/httplib_header.h"
#include "pipeline/calibration/rig_yaml.h"
#include "tests/firmware/log_capture.h"
#include "tests/firmware/runtime/fake_manager.h"
#include "tests/support/mock_gpio.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using test::MockGpio;

const std::filesystem::path kSourceFolder = BEVLOC_SOURCE_DIR;
/// The daemon calls `stop` ten times per second. After this many calls the test fails.
constexpr int kMaxCalls = 300;

/// An endpoint that calls a function when it is closed.
class ClosingBus final : public can::Bus {
 public:
  ClosingBus(std::unique_ptr<can::Bus> bus, std::function<void()> closes)
      : bus_(std::move(bus)), closes_(std::move(closes)) {}
  ~ClosingBus() override { closes_(); }
  ClosingBus(const ClosingBus&) = delete;
  ClosingBus& operator=(const ClosingBus&) = delete;

  can::SendResult send(const can::Frame& frame, Time now) override {
    return bus_->send(frame, now);
  }
  std::optional<can::ReceivedFrame> receive() override { return bus_->receive(); }
  bool wait(Duration timeout) override { return bus_->wait(timeout); }
  can::BusCounters counters() const override { return bus_->counters(); }
  can::BusCondition condition() const override { return bus_->condition(); }

 private:
  const std::unique_ptr<can::Bus> bus_;
  const std::function<void()> closes_;
};

class DaemonTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const std::string_view camera : kCameraNames) {
      std::filesystem::create_directories(folder_ / camera);
      std::ofstream(folder_ / camera / "frames.txt") << "0 0 none.png\n";
      std::ofstream(folder_ / camera / "none.png") << "";
    }
    config_.cameras.driver = CameraDriver::kReplay;
    config_.cameras.recording = folder_.path();
    config_.map_file = kSourceFolder / "tests/pipeline/map/fixtures/street.osm";
    config_.model_file = kSourceFolder / "models/nano.onnx";
    config_.gpio.fault = drivers::LineAddress{MockGpio::kChip, "fault", true};
    config_.gpio.ignition = IgnitionConfig{{MockGpio::kChip, "ignition"}, milliseconds(50)};
    config_.gpio.trigger = TriggerLineConfig{{MockGpio::kChip, "trigger"}, {}};
    gpio_.drive("ignition", true);
  }

  Status run(const std::function<bool()>& stop) {
    const auto rig = read_rig(kSourceFolder / "config/rig_demo.yaml");
    EXPECT_TRUE(rig) << rig.error().message;
    return run_daemon(config_, *rig, {gpio_, open_bus_, stop, nullptr});
  }

  /// Runs, switches the ignition off, calls `change` in standby, and switches the ignition on
  /// again. Ends when the appliance runs again.
  Status run_again_after(const std::function<void()>& change) {
    FakeManager manager;
    std::string messages;
    const auto tells = [&](const char* text) {
      messages += manager.all();
      const bool told = messages.find(text) != std::string::npos;
      if (told) messages.clear();
      return told;
    };
    int calls = 0;
    int step = 0;
    return run([&] {
      if (step == 0 && tells("READY=1")) {
        gpio_.drive("ignition", false);
        step = 1;
      } else if (step == 1 && tells("STATUS=standby")) {
        change();
        gpio_.drive("ignition", true);
        step = 2;
      } else if (step == 2 && tells("READY=1")) {
        step = 3;
      }
      EXPECT_LT(++calls, kMaxCalls);
      return step == 3 || calls == kMaxCalls;
    });
  }

  bool fault() const { return !gpio_.high("fault"); }  // active low

  const test::TemporaryFolder folder_;
  Config config_;
  drivers::MonotonicClock clock_;
  MockGpio gpio_{{"trigger", "fault", "ignition"}, clock_};
  can::MockWire wire_{4096};
  OpenBus open_bus_ = [this] { return wire_.connect(); };
};

TEST_F(DaemonTest, WaitsInStandbyWhileTheIgnitionIsOffAndRunsAgain) {
  FakeManager manager;
  setenv("WATCHDOG_USEC", "2000000", 1);
  std::string messages;
  const auto see = [&](const std::string& text) {
    messages += manager.all();
    return messages.find(text) != std::string::npos;
  };
  int calls = 0;
  int step = 0;
  bool fault_in_standby = false;
  const auto bus = wire_.connect();
  const Status status = run([&] {
    if (step == 0 && see("READY=1") && !fault()) {
      gpio_.drive("ignition", false);
      messages.clear();
      step = 1;
    } else if (step == 1 && see("STATUS=standby: ignition off") && see("WATCHDOG=1")) {
      fault_in_standby = fault();
      EXPECT_LT(messages.find("WATCHDOG_USEC=30000000"), messages.find("STATUS=standby"))
          << "nobody feeds the watchdog while the devices close";
      while (bus->receive()) {
      }
      EXPECT_EQ(messages.find("STOPPING"), std::string::npos);
      messages.clear();
      gpio_.drive("ignition", true);
      step = 2;
    } else if (step == 2 && see("READY=1") && !fault() && bus->receive()) {
      step = 3;
    }
    return step == 3 || ++calls == kMaxCalls;
  });
  unsetenv("WATCHDOG_USEC");
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_EQ(step, 3);
  EXPECT_TRUE(fault_in_standby);
  EXPECT_TRUE(see("STOPPING=1"));
  EXPECT_TRUE(fault());
  EXPECT_FALSE(gpio_.high("trigger"));
  EXPECT_GE(gpio_.changes("trigger").size(), 2U);
  // All lines were released.
  EXPECT_TRUE(gpio_.open_input({MockGpio::kChip, "ignition"}));
  EXPECT_TRUE(gpio_.open_output({MockGpio::kChip, "trigger"}, false));
}

TEST_F(DaemonTest, SaysWhatItDoesWhileTheIgnitionChanges) {
  const int port = HttpServer::open("127.0.0.1", 0).value()->port();  // it is free again
  config_.live.emplace().port = port;
  const auto health = [port] {
    const auto answer = httplib::Client("127.0.0.1", port).Get("/healthz");
    return answer ? answer->body : "no answer";
  };
  std::vector<std::string> opening;
  std::vector<std::string> closing;
  open_bus_ = [&] {
    opening.push_back(health());
    return std::make_unique<ClosingBus>(wire_.connect(), [&] { closing.push_back(health()); });
  };
  const Status status = run_again_after([] {});
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_THAT(opening, testing::ElementsAre("starting\n", "starting\n"));
  ASSERT_EQ(closing.size(), 2U);
  EXPECT_EQ(closing[0], "standby: ignition off\n");
}

TEST_F(DaemonTest, ChecksTheManifestAgainWhenTheIgnitionReturns) {
  const std::filesystem::path model = folder_ / "model.onnx";
  std::filesystem::copy_file(config_.model_file, model);
  config_.model_file = model;
  config_.manifest_file = folder_ / "bevloc.manifest";
  std::string manifest;
  for (const auto& file : {config_.model_file, config_.map_file}) {
    manifest += sha256_hex(read_file(file).value()) + "  " + file.string() + "\n";
  }
  ASSERT_TRUE(write_file(config_.manifest_file, manifest));
  const Status unchanged = run_again_after([] {});
  EXPECT_TRUE(unchanged) << unchanged.error().message;
  const Status changed = run_again_after([&] {
    std::string bytes = read_file(model).value();
    bytes.back() = static_cast<char>(bytes.back() ^ 1);
    EXPECT_TRUE(write_file(model, bytes));
  });
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().message, testing::HasSubstr("model.onnx: found SHA-256"));
}

TEST_F(DaemonTest, NamesTheRigInUseAlthoughItsFileHasChanged) {
  config_.rig_file = folder_ / "rig.yaml";
  std::filesystem::copy_file(kSourceFolder / "config/rig_demo.yaml", config_.rig_file);
  config_.kept_files.keep(config_.rig_file);
  const std::string rig = fmt::format(", rig {:08x},", crc32(read_file(config_.rig_file).value()));
  const LogCapture log;
  const Status status =
      run_again_after([&] { std::ofstream(config_.rig_file, std::ios::app) << "# another rig\n"; });
  EXPECT_TRUE(status) << status.error().message;
  const size_t first = log.text().find(rig);
  ASSERT_NE(first, std::string::npos) << log.text();
  EXPECT_NE(log.text().find(rig, first + 1), std::string::npos) << log.text();
}

TEST_F(DaemonTest, ATriggerThatFailsIsLoggedOnce) {
  const LogCapture log;
  int calls = 0;
  EXPECT_TRUE(run([&] {
    if (++calls == 3) gpio_.unplug();
    return calls == 8;
  }));
  const std::string line = "gpio: trigger: ";
  const size_t first = log.text().find(line);
  ASSERT_NE(first, std::string::npos) << log.text();
  EXPECT_EQ(log.text().find(line, first + 1), std::string::npos) << log.text();
}

TEST_F(DaemonTest, EndsInStandby) {
  gpio_.drive("ignition", false);
  int calls = 0;
  EXPECT_TRUE(run([&] { return ++calls == 3; }));
  EXPECT_EQ(calls, 3);
  EXPECT_TRUE(gpio_.changes("trigger").empty());
}

TEST_F(DaemonTest, RunsWhileTheIgnitionIsOn) {
  int calls = 0;
  const Status status = run([&] { return ++calls == 5; });
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_EQ(calls, 5);
}

TEST_F(DaemonTest, RunsWithoutARecordingIfTheDiskTakesNone) {
  config_.record.emplace().directory = "/proc/no/such";
  const LogCapture log;
  int calls = 0;
  const Status status = run([&] { return ++calls == 3; });
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_EQ(calls, 3);
  EXPECT_NE(log.text().find("nothing is recorded: /proc/no/such"), std::string::npos) << log.text();
}

TEST_F(DaemonTest, RunsWithoutALivePageIfItCannotBeServed) {
  config_.live.emplace().address = "192.0.2.1";  // of another machine (RFC 5737)
  const LogCapture log;
  int calls = 0;
  const Status status = run([&] { return ++calls == 3; });
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_EQ(calls, 3);
  EXPECT_NE(log.text().find("error: no live page: live: found no way to listen at 192.0.2.1"),
            std::string::npos)
      << log.text();
}

bool has_thread(const std::string& wanted) {
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(thread.path() / "comm"), name);
    if (name == wanted) return true;
  }
  return false;
}

// The kernel still lists a thread for a moment after it was joined.
bool thread_ends(const std::string& name) {
  for (int tries = 0; tries < 1000; ++tries) {
    if (!has_thread(name)) return true;
  }
  return false;
}

TEST_F(DaemonTest, KeepsWhatItLearnsInAThreadOfItsOwn) {
  for (const bool with_file : {false, true}) {
    if (with_file) config_.learned_calibration_file = folder_ / "calibration.yaml";
    int calls = 0;
    bool seen = false;
    const Status status = run([&] {
      seen |= has_thread("calibration");
      return ++calls == (with_file ? kMaxCalls : 5) || seen;
    });
    EXPECT_TRUE(status) << status.error().message;
    EXPECT_EQ(seen, with_file);
  }
  EXPECT_TRUE(thread_ends("calibration"));
  EXPECT_FALSE(std::filesystem::exists(config_.learned_calibration_file)) << "nothing was learned";
}

TEST_F(DaemonTest, DoesNotStartWithoutAConfiguredLine) {
  config_.gpio.ignition->address.line = "key";
  const Status status = run([] { return true; });
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, testing::StartsWith("gpio: mock key: "));
}

}  // namespace
}  // namespace bevloc::firmware
