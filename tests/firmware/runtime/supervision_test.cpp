// Stops the appliance's threads one after the other, with cameras and a bus that can hang.
#include <deque>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>

#include "can/bus/mock_bus.h"
#include "can/bus/send_gate.h"
#include "can/publisher/pose_publisher.h"
#include "evaluation/drive/pose_reader.h"
#include "firmware/runtime/runner.h"
#include "firmware/runtime/supervisor.h"
#include "firmware/runtime/trigger_thread.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_loader.h"
#include "tests/firmware/runtime/fake_manager.h"
#include "tests/support/mock_gpio.h"

namespace bevloc::firmware {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;

const std::filesystem::path kSources = BEVLOC_SOURCE_DIR;

/// Holds the thread of one name.
class Gate {
 public:
  void close(const std::string& thread) {
    const std::lock_guard lock(mutex_);
    closed_for_ = thread;
  }
  void open() {
    {
      const std::lock_guard lock(mutex_);
      closed_for_.clear();
    }
    opened_.notify_all();
  }
  /// Waits while the gate is closed for the calling thread.
  void pass() {
    char name[16] = {};
    pthread_getname_np(pthread_self(), name, sizeof name);
    std::unique_lock lock(mutex_);
    opened_.wait(lock, [&] { return closed_for_ != name; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  std::string closed_for_;
};

/// The machine's clock behind the gate. Each thread but CAN in reads it at each turn.
class GatedClock final : public drivers::Clock {
 public:
  explicit GatedClock(Gate& gate) : gate_(gate) {}
  Time now() const override {
    gate_.pass();
    return clock_.now();
  }
  void sleep_until(Time time) override {
    gate_.pass();
    clock_.sleep_until(time);
  }
  Duration suspended() const override { return clock_.suspended(); }
  Duration unsteered() const override { return clock_.unsteered(); }

 private:
  Gate& gate_;
  drivers::MonotonicClock clock_;
};

/// A camera that runs but delivers no frame, and whose next_frame() may hang.
class SilentCamera final : public drivers::Camera {
 public:
  SilentCamera(int camera, Gate& gate) : camera_(camera), gate_(gate) {}
  Status start() override { return {}; }
  void stop() override {}
  Result<drivers::FrameEvent> next_frame(Duration, drivers::Frame&) override {
    gate_.pass();
    std::this_thread::sleep_for(milliseconds(1));
    return drivers::FrameEvent::kTimeout;
  }
  drivers::CameraDescription description() const override { return {.camera = camera_}; }
  drivers::CameraCounters counters() const override { return {}; }

 private:
  const int camera_;
  Gate& gate_;
};

/// A bus whose wait() may hang. It says on stderr when LOST is sent.
class GatedBus final : public can::Bus {
 public:
  GatedBus(std::unique_ptr<can::Bus> bus, Gate& gate) : bus_(std::move(bus)), gate_(gate) {}
  can::SendResult send(const can::Frame& frame, Time now) override {
    reader_.accept({frame, now});
    if (reader_.state() == HealthState::kLost) fmt::print(stderr, "LOST was sent\n");
    return bus_->send(frame, now);
  }
  std::optional<can::ReceivedFrame> receive() override { return bus_->receive(); }
  bool wait(Duration timeout) override {
    gate_.pass();
    return bus_->wait(timeout);
  }
  can::BusCounters counters() const override { return bus_->counters(); }
  can::BusCondition condition() const override { return bus_->condition(); }

 private:
  std::unique_ptr<can::Bus> bus_;
  Gate& gate_;
  evaluation::PoseReader reader_{{}, {}};
};

/// A bus like that of the kernel: one frame of each identifier at a time, and each is on the wire 1
/// ms later. Only receive() frees the place.
class SlowBus final : public can::Bus {
 public:
  SlowBus(std::span<const uint32_t> ids, const can::BaseIds& base,
          std::atomic<HealthState>& state_on_wire)
      : places_(ids), reader_(base, {}), state_on_wire_(state_on_wire) {}
  can::SendResult send(const can::Frame& frame, Time now) override {
    const std::lock_guard lock(mutex_);
    if (!places_.enter(frame.id, now)) return can::SendResult::kWaiting;
    ++counters_.sent;
    on_the_way_.push_back({frame.id, clock_.now() + milliseconds(1)});
    reader_.accept({frame, now});
    state_on_wire_ = reader_.state();
    return can::SendResult::kSent;
  }
  std::optional<can::ReceivedFrame> receive() override {
    const std::lock_guard lock(mutex_);
    for (; has_echo(); on_the_way_.pop_front()) {
      places_.confirm(on_the_way_.front().id, clock_.now());
      ++counters_.confirmed;
    }
    return std::nullopt;
  }
  bool wait(Duration timeout) override {
    const Time end = clock_.now() + timeout;
    for (; clock_.now() < end; std::this_thread::sleep_for(std::chrono::microseconds(200))) {
      const std::lock_guard lock(mutex_);
      if (has_echo()) return true;
    }
    return false;
  }
  can::BusCounters counters() const override {
    const std::lock_guard lock(mutex_);
    return counters_;
  }
  can::BusCondition condition() const override { return {}; }

 private:
  struct Echo {
    uint32_t id = 0;
    Time due{};
  };

  bool has_echo() const { return !on_the_way_.empty() && on_the_way_.front().due <= clock_.now(); }

  mutable std::mutex mutex_;
  drivers::MonotonicClock clock_;
  can::SendGate places_;
  std::deque<Echo> on_the_way_;
  can::BusCounters counters_;
  evaluation::PoseReader reader_;
  std::atomic<HealthState>& state_on_wire_;
};

class SupervisionTest : public testing::Test {
 protected:
  SupervisionTest() {
    config_.model_file = kSources / "models/nano.onnx";
    make_appliance(std::make_unique<GatedBus>(wire_.connect(), gate_));
  }

  void make_appliance(std::unique_ptr<can::Bus> bus) {
    supervisor_.reset();
    watchdog_.reset();
    Hardware hardware;
    for (int camera = 0; camera < kCameraCount; ++camera) {
      hardware.cameras.push_back(std::make_unique<SilentCamera>(camera, gate_));
    }
    hardware.bus = std::move(bus);
    hardware.clock = &clock_;
    appliance_ = Appliance::create(config_, rig_, map_, std::move(hardware)).value();
    watchdog_.emplace(appliance_->estimation().counters().state);
    supervisor_.emplace(*appliance_, realtime_, *watchdog_);
  }

  /// Runs all threads; the one that calls the supervisor has the name "supervisor".
  void run() {
    name_this_thread("supervisor");
    run_threads(*appliance_, realtime_, nullptr, [this](Time now) {
      supervisor_->step(now);
      return running_.load();
    });
  }

  Config config_;
  Rig rig_ = read_rig(kSources / "config/rig_demo.yaml").value();
  HdMap map_ = load_map(kSources / "tests/pipeline/map/fixtures/street.osm").value();
  Gate gate_;
  GatedClock clock_{gate_};
  can::MockWire wire_{4096};
  Realtime realtime_{{}};
  std::unique_ptr<Appliance> appliance_;
  std::optional<Watchdog> watchdog_;
  std::optional<Supervisor> supervisor_;
  std::atomic<bool> running_{true};
};

/// Real threads, but the watchdog's time is virtual: before each of its steps, every thread that is
/// not held has beaten.
TEST_F(SupervisionTest, EveryThreadThatStopsIsNamedAndStopsTheFeed) {
  drivers::MonotonicClock machine;
  test::MockGpio gpio({"trigger"}, machine);
  const auto trigger =
      TriggerThread::start({{test::MockGpio::kChip, "trigger"}, {}}, gpio, clock_, realtime_)
          .value();
  std::map<std::string, const Heartbeat*> threads{{"vision", &appliance_->heartbeats().vision},
                                                  {"can-in", &appliance_->heartbeats().can_in},
                                                  {"can-out", &appliance_->heartbeats().can_out},
                                                  {"trigger", &trigger->heartbeat()},
                                                  {"supervisor", &supervisor_->heartbeat()}};
  for (int camera = 0; camera < kCameraCount; ++camera) {
    threads[fmt::format("cam-{}", kCameraNames[camera])] =
        &appliance_->capture()[camera].heartbeat();
  }
  watchdog_->watch_stages(*appliance_);
  watchdog_->watch("trigger", trigger->heartbeat());
  watchdog_->watch("supervisor", supervisor_->heartbeat());
  FakeManager manager;
  Time now(milliseconds(1000));
  const auto step = [&](const std::string& held) {
    std::map<std::string, uint64_t> before;
    for (const auto& [name, heartbeat] : threads) before[name] = heartbeat->count();
    for (const auto& [name, heartbeat] : threads) {
      while (name != held && heartbeat->count() == before[name]) std::this_thread::yield();
    }
    watchdog_->step(now += milliseconds(250));
    return manager.all();
  };

  std::jthread thread([this] { run(); });
  EXPECT_THAT(step(""), HasSubstr("READY=1"));
  for (const auto& [name, heartbeat] : threads) {
    gate_.close(name);
    step(name);  // the thread may still turn once
    for (int quarters = 1; quarters < 4; ++quarters) step(name);
    EXPECT_THAT(step(name), Not(HasSubstr("WATCHDOG=1"))) << name << ": one second later";
    EXPECT_EQ(watchdog_->hung(), name);
    gate_.open();
    EXPECT_THAT(step(""), HasSubstr("WATCHDOG=1")) << name;
  }
  running_ = false;
}

TEST_F(SupervisionTest, TheSupervisorWatchesTheWatchdog) {
  Time now(milliseconds(1000));
  watchdog_->step(now);
  for (int tenths = 0; tenths < 10; ++tenths) supervisor_->step(now += milliseconds(100));
  EXPECT_EQ(supervisor_->view().hung, "watchdog");
  watchdog_->step(now);
  supervisor_->step(now);
  EXPECT_EQ(supervisor_->view().hung, "");
}

/// A frame of the last cycle is still in the kernel when the threads have ended.
TEST_F(SupervisionTest, TheLastMessageSaysLost) {
  for (const can::FrameFormat format : {can::FrameFormat::kClassic, can::FrameFormat::kFd}) {
    config_.can.variant = format;
    std::atomic<HealthState> state_on_wire{HealthState::kFault};
    const auto ids = can::PosePublisher::sent_ids(config_.can.base_ids, format, false, false);
    make_appliance(std::make_unique<SlowBus>(ids, config_.can.base_ids, state_on_wire));
    running_ = true;
    std::jthread stopping([this] {
      while (appliance_->bus().counters().confirmed < 100) std::this_thread::yield();
      running_ = false;
    });
    run();
    EXPECT_EQ(state_on_wire, HealthState::kLost);
  }
}

TEST_F(SupervisionTest, AnExceptionOfTheSupervisorEndsTheThreadsAndArrives) {
  const auto fails = [](Time) -> bool { throw std::runtime_error("supervisor"); };
  EXPECT_THROW(run_threads(*appliance_, realtime_, nullptr, fails), std::runtime_error);
}

using SupervisionDeathTest = SupervisionTest;

TEST_F(SupervisionDeathTest, AThreadThatHangsDoesNotKeepTheDaemonFromSayingLost) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        gate_.close("vision");
        running_ = false;
        run();
      },
      testing::ExitedWithCode(kHungExitCode), "LOST was sent");
}

}  // namespace
}  // namespace bevloc::firmware
