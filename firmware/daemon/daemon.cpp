#include "firmware/daemon/daemon.h"

#include <thread>

#include <spdlog/spdlog.h>

#include "firmware/config/config_key.h"
#include "firmware/config/manifest.h"
#include "firmware/devices/camera_factory.h"
#include "firmware/devices/fault_line.h"
#include "firmware/devices/gpio_lines.h"
#include "firmware/devices/status_led.h"
#include "firmware/live/live_server.h"
#include "firmware/recording/recorder_thread.h"
#include "firmware/recording/recording_session.h"
#include "firmware/runtime/calibration_saver.h"
#include "firmware/runtime/clock_watch.h"
#include "firmware/runtime/runner.h"
#include "firmware/runtime/supervisor.h"
#include "firmware/runtime/trigger_thread.h"
#include "firmware/runtime/watchdog.h"
#include "firmware/status/error_log.h"
#include "firmware/status/totals_log.h"
#include "firmware/status/view_log.h"
#include "firmware/threads/realtime.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/map/map_summary.h"

namespace bevloc::firmware {
namespace {

constexpr Duration kStandbyPeriod = std::chrono::milliseconds(100);
/// The longest time for the start or the end of an appliance. Its start takes about a second, and
/// its end as long as the slowest device takes to close. systemd/bevlocd.service allows the daemon
/// the same time to start.
constexpr Duration kChangeTimeout = std::chrono::seconds(30);

/// The daemon's devices that live from its start to its end.
struct Base {
  explicit Base(const RealtimeConfig& realtime_config) : realtime(realtime_config) {}

  drivers::MonotonicClock clock;
  Realtime realtime;
  std::unique_ptr<FaultLine> fault;
  std::unique_ptr<GpioLines> lines;
  HdMap map;
  std::unique_ptr<LiveServer> live;  ///< null without one
};

/// Shows a phase without an appliance on the live page, if there is one.
void show_phase(Phase phase, Base& base) {
  if (base.live) base.live->publish({phase, base.clock.now(), {}, {}});
}

/// Waits until the ignition is on. Returns false if the daemon shall end. No thread of the
/// appliance runs meanwhile, so this thread feeds the watchdog itself.
bool wait_for_ignition(Base& base, const DaemonHost& host) {
  ServiceNotifier notifier;
  for (bool first = true; !base.lines->step(false, base.clock.now()); first = false) {
    if (first) {
      spdlog::info("ignition off: standby");
      notifier.ready();
      notifier.status("standby: ignition off");
      show_phase(Phase::kStandby, base);
    }
    notifier.feed_watchdog();
    if (host.stop()) {
      notifier.stopping();
      return false;
    }
    base.clock.sleep_until(base.clock.now() + kStandbyPeriod);
  }
  // Nobody can feed the watchdog while the appliance starts.
  notifier.set_watchdog_timeout(kChangeTimeout);
  show_phase(Phase::kStarting, base);
  return true;
}

/// Shows an appliance on the live page, if there is one, for the life of this object.
class LiveView {
 public:
  LiveView(LiveServer* live, Appliance& appliance, const Rig& rig) : live_(live) {
    if (live_ != nullptr) live_->attach(appliance, rig);
  }
  ~LiveView() {
    if (live_ != nullptr) live_->detach();
  }
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

 private:
  LiveServer* live_;
};

/// Runs a complete appliance until the ignition goes off (true) or the daemon shall end (false).
bool run_appliance(Appliance& appliance, const Rig& rig, TriggerThread* trigger,
                   const Recorder* recorder, Base& base, const Config& config,
                   const DaemonHost& host) {
  Watchdog watchdog(appliance.estimation().counters().state, base.fault.get());
  watchdog.watch_stages(appliance);
  Supervisor supervisor(appliance, base.realtime, watchdog);
  watchdog.watch("supervisor", supervisor.heartbeat());
  if (trigger != nullptr) watchdog.watch("trigger", trigger->heartbeat());
  if (host.log != nullptr) watchdog.watch("log", host.log->heartbeat());
  std::jthread watching = start_watchdog(watchdog, *base.fault, base.clock);

  const auto snapshot = [&] {
    return take_snapshot(appliance, {.trigger = trigger != nullptr ? &trigger->trigger() : nullptr,
                                     .recording = totals_of(config, recorder),
                                     .log_dropped = host.log != nullptr ? host.log->dropped() : 0});
  };
  ViewLog log;
  ErrorLog errors;
  ClockWatch clock_watch(config.clock);
  ShownState shown;
  bool ignition = true;
  const LiveView live_view(base.live.get(), appliance, rig);
  run_threads(appliance, base.realtime, nullptr, [&](Time now) {
    supervisor.step(now);
    const uint64_t clock_gaps = appliance.estimation().counters().clock_gaps;
    appliance.estimation().note_clock(clock_watch.step(), clock_gaps);
    log.note(supervisor.view(), now);
    const Snapshot counters = snapshot();
    errors.note(counters, now);
    if (base.live) base.live->publish({Phase::kRunning, now, counters, supervisor.view()});
    const ApplianceView& view = supervisor.view();
    ignition = base.lines->step(is_lit(shown.of(view.state, view.lost, now), now), now);
    const bool goes_on = ignition && !host.stop();
    // Nobody can feed the watchdog, or publish, while the devices close. When the daemon itself
    // ends, systemd waits longer anyway.
    if (!ignition) {
      ServiceNotifier().set_watchdog_timeout(kChangeTimeout);
      show_phase(Phase::kStandby, base);
    }
    if (!goes_on) watching.request_stop();  // the fault line becomes active
    return goes_on;
  });
  if (ignition) supervisor.finish();
  if (trigger != nullptr) trigger->stop();
  log_totals(snapshot());
  return !ignition;
}

/// Opens the recorder. Returns null if nothing is recorded. A failure is only logged, because the
/// vehicle needs its pose even when the disk is full or broken.
std::unique_ptr<Recorder> recorder_for(const Config& config, const Rig& rig, const Base& base) {
  auto recorder = open_recorder(config, rig, base.map, false, base.clock.now());
  if (recorder) return std::move(*recorder);
  spdlog::error("nothing is recorded: {}", recorder.error().message);
  return nullptr;
}

/// Starts the live page if it is configured and does not run yet. A failure is only logged, because
/// the vehicle needs its pose even when another program has the port, or the network is not up.
void serve_page(const Config& config, Base& base) {
  if (!config.live || base.live) return;
  auto live = LiveServer::start(*config.live);
  if (!live) return spdlog::error("no live page: {}", live.error().message);
  base.live = std::move(*live);
}

/// Opens the remaining devices and runs an appliance on them. Returns what run_appliance() returns.
Result<bool> start_and_run(const Config& config, const Rig& rig, Base& base,
                           const DaemonHost& host) {
  // The appliance reads the model now, and an upgrade may have replaced it while it was off.
  if (Status same = check_manifest_of(config); !same) return tl::unexpected(same.error());
  std::unique_ptr<TriggerThread> trigger;
  if (config.gpio.trigger) {
    auto started = TriggerThread::start(*config.gpio.trigger, host.gpio, base.clock, base.realtime);
    if (!started) return tl::unexpected(started.error());
    trigger = std::move(*started);
  }
  auto bus = host.open_bus();
  if (!bus) return tl::unexpected(bus.error());
  auto cameras = make_cameras(config.cameras, rig, base.clock);
  if (!cameras) return tl::unexpected(cameras.error());
  Hardware hardware{std::move(*cameras), std::move(*bus), &base.clock,
                    trigger ? &trigger->trigger().pulses() : nullptr};
  const auto recorder = recorder_for(config, rig, base);
  if (recorder) tap(hardware, *recorder);
  auto appliance = Appliance::create(config, rig, base.map, std::move(hardware));
  if (!appliance) return tl::unexpected(appliance.error());
  std::jthread recording;
  if (recorder) {
    watch(**appliance, *recorder);
    recording = start_recording(*recorder, base.clock);
  }
  const auto saver = make_calibration_saver(config, rig, (*appliance)->localizer());
  std::jthread saving;
  if (saver) {
    saver->watch((*appliance)->vision(), base.clock);
    saving = start_saving(*saver);
  }
  return run_appliance(**appliance, rig, trigger.get(), recorder.get(), base, config, host);
}

}  // namespace

Status run_daemon(const Config& config, const Rig& rig, const DaemonHost& host) {
  Base base(config.realtime);
  // The fault line comes first, so that it is active while the rest starts.
  auto fault = FaultLine::open(config.gpio.fault, host.gpio);
  if (!fault) return tl::unexpected(fault.error());
  base.fault = std::move(*fault);
  auto lines = GpioLines::open(config.gpio, host.gpio, base.clock.now());
  if (!lines) return tl::unexpected(lines.error());
  base.lines = std::move(*lines);
  auto map = at_key("map.file", load_map(config.map_file));
  if (!map) return tl::unexpected(map.error());
  base.map = std::move(*map);
  spdlog::info("map: {}", contents_of(base.map));
  for (const std::string& warning : warnings_of(base.map)) spdlog::warn("map: {}", warning);

  serve_page(config, base);
  while (wait_for_ignition(base, host)) {
    serve_page(config, base);
    const auto ignition_went_off = start_and_run(config, rig, base, host);
    if (!ignition_went_off) return tl::unexpected(ignition_went_off.error());
    if (!*ignition_went_off) break;
  }
  return {};
}

void set_log_level(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::set_level(spdlog::level::debug);
    case LogLevel::kInfo:
      return spdlog::set_level(spdlog::level::info);
    case LogLevel::kWarning:
      return spdlog::set_level(spdlog::level::warn);
    case LogLevel::kError:
      return spdlog::set_level(spdlog::level::err);
  }
}

}  // namespace bevloc::firmware
