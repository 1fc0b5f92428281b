#include "firmware/daemon.h"

#include <spdlog/spdlog.h>

#include "firmware/bus_factory.h"
#include "firmware/camera_factory.h"
#include "firmware/gpio_lines.h"
#include "firmware/realtime.h"
#include "firmware/runner.h"
#include "firmware/supervisor.h"
#include "firmware/view_log.h"
#include "pipeline/map/map_loader.h"

namespace bevloc::firmware {
namespace {

void log_unreadable(const VisionCounters& vision) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (const uint64_t pictures = vision.unreadable[camera]; pictures > 0) {
      spdlog::warn("camera {}: {} pictures could not be read", kCameraNames[camera], pictures);
    }
  }
}

void log_bus(const can::BusCounters& bus) {
  const double mean_ms = bus.confirmed == 0 ? 0.0
                                            : 1e3 * to_seconds(bus.confirmation_total) /
                                                  static_cast<double>(bus.confirmed);
  spdlog::info(
      "CAN: {} sent, {} confirmed after {:.2f} ms on average and {:.2f} ms at most, {} replaced by "
      "newer ones, {} too old, {} while down",
      bus.sent, bus.confirmed, mean_ms, 1e3 * to_seconds(bus.confirmation_max), bus.send_replaced,
      bus.send_expired, bus.send_bus_down);
  spdlog::info(
      "CAN: {} received ({} stamped by hardware, {} by the kernel), {} lost, {} ignored, {} error "
      "reports, {} times bus-off, {} times found again",
      bus.received, bus.hardware_stamped, bus.software_stamped, bus.receive_dropped,
      bus.receive_ignored, bus.error_frames, bus.bus_off, bus.reopened);
}

}  // namespace

Status run_daemon(const Config& config, const Rig& rig, drivers::Gpio& gpio,
                  const std::function<bool()>& stop) {
  drivers::MonotonicClock clock;
  Realtime realtime(config.realtime);
  // First of all, so that the fault line is active while the rest starts.
  auto lines = GpioLines::open(config.gpio, gpio, clock, realtime);
  if (!lines) return tl::unexpected(lines.error());
  const drivers::Trigger* const trigger = (*lines)->trigger();
  const auto map = load_map(config.map.file);
  if (!map) return tl::unexpected(map.error());
  BusFactory buses(config.can);
  auto bus = buses.connect_appliance();
  if (!bus) return tl::unexpected(bus.error());
  auto cameras = make_cameras(config.cameras, rig, clock);
  if (!cameras) return tl::unexpected(cameras.error());

  auto appliance = Appliance::create(
      config, rig, *map,
      {std::move(*cameras), std::move(*bus), &clock, trigger ? &trigger->pulses() : nullptr});
  if (!appliance) return tl::unexpected(appliance.error());
  spdlog::info("map {} with {} elements, model {}", map->name, map->elements.size(),
               (*appliance)->localizer().model_name());

  Supervisor supervisor(**appliance, realtime);
  ViewLog log;
  run_threads(**appliance, realtime, nullptr, [&](Time now) {
    supervisor.step(now);
    log.note(supervisor.view());
    const bool ignition = (*lines)->step(supervisor.view(), now);
    if (!ignition) spdlog::info("ignition is off");
    return ignition && !stop();
  });
  supervisor.finish();
  (*lines)->stop_trigger();
  const FrameCounts frames = (*appliance)->frame_counts();
  spdlog::info(
      "stopped: {} frames captured, {} used, {} dropped ({} for newer ones, {} without a set, "
      "{} in skipped sets, {} under way); {} more missed",
      frames.captured, frames.used, frames.dropped(), frames.displaced, frames.mismatched,
      frames.skipped, frames.under_way(), frames.missed);
  log_unreadable((*appliance)->vision().counters());
  log_synchrony((*appliance)->vision().synchrony(), trigger);
  log_bus((*appliance)->bus().counters());
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
