#include "firmware/runtime/daemon.h"

#include <spdlog/spdlog.h>

#include "firmware/runtime/camera_factory.h"
#include "firmware/runtime/gpio_lines.h"
#include "firmware/runtime/realtime.h"
#include "firmware/runtime/runner.h"
#include "firmware/runtime/supervisor.h"
#include "firmware/telemetry/totals_log.h"
#include "firmware/telemetry/view_log.h"
#include "pipeline/map/map_loader.h"

namespace bevloc::firmware {

Status run_daemon(const Config& config, const Rig& rig, drivers::Gpio& gpio,
                  const OpenBus& open_bus, const std::function<bool()>& stop) {
  drivers::MonotonicClock clock;
  Realtime realtime(config.realtime);
  // The GPIO lines come first, so that the fault line is active while the rest starts.
  auto lines = GpioLines::open(config.gpio, gpio, clock, realtime);
  if (!lines) return tl::unexpected(lines.error());
  const drivers::Trigger* const trigger = (*lines)->trigger();
  const auto map = load_map(config.map_file);
  if (!map) return tl::unexpected(map.error());
  auto bus = open_bus();
  if (!bus) return tl::unexpected(bus.error());
  auto cameras = make_cameras(config.cameras, rig, clock);
  if (!cameras) return tl::unexpected(cameras.error());

  auto appliance = Appliance::create(
      config, rig, *map,
      {std::move(*cameras), std::move(*bus), &clock, trigger ? &trigger->pulses() : nullptr});
  if (!appliance) return tl::unexpected(appliance.error());

  Supervisor supervisor(**appliance, realtime);
  ViewLog log;
  run_threads(**appliance, realtime, nullptr, [&](Time now) {
    supervisor.step(now);
    log.note(supervisor.view());
    const bool ignition = (*lines)->step(supervisor.view(), now);
    if (!ignition) spdlog::info("ignition off: stopping");
    return ignition && !stop();
  });
  supervisor.finish();
  (*lines)->stop_trigger();
  log_totals(**appliance, trigger);
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
