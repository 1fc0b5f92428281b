#include "firmware/daemon.h"

#include <spdlog/spdlog.h>

#include "drivers/camera/replay_camera.h"
#include "firmware/bus_factory.h"
#include "firmware/runner.h"
#include "firmware/supervisor.h"
#include "pipeline/map/map_loader.h"

namespace bevloc::firmware {
namespace {

/// Recordings begin a little after now, so that every camera is ready for its first picture.
constexpr Duration kReplayLead = std::chrono::seconds(1);

/// Replays of one recording, all shifted by the same time so that it begins now.
Result<std::vector<std::unique_ptr<drivers::Camera>>> open_recording(const Config& config,
                                                                     const Rig& rig,
                                                                     drivers::Clock& clock) {
  std::vector<drivers::ReplayCameraConfig> replays;
  Time first = Time::max();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    drivers::ReplayCameraConfig replay;
    replay.camera = camera;
    replay.directory = config.cameras.recording / kCameraNames[camera];
    replay.width_px = rig.cameras[camera].intrinsics.width_px;
    replay.height_px = rig.cameras[camera].intrinsics.height_px;
    replay.buffers = config.cameras.buffers;
    const auto frames = drivers::load_recording(replay.directory);
    if (!frames) return tl::unexpected(frames.error());
    if (!frames->empty()) first = std::min(first, frames->front().time);
    replays.push_back(replay);
  }
  std::vector<std::unique_ptr<drivers::Camera>> cameras;
  for (drivers::ReplayCameraConfig& replay : replays) {
    replay.shift = clock.now() + kReplayLead - first;
    cameras.push_back(std::make_unique<drivers::ReplayCamera>(replay, clock));
  }
  return cameras;
}

}  // namespace

Status run_daemon(const Config& config, const Rig& rig, const std::function<bool()>& stop) {
  drivers::MonotonicClock clock;
  const auto map = load_map(config.map.file);
  if (!map) return tl::unexpected(map.error());
  BusFactory buses(config.can);
  auto bus = buses.connect_appliance();
  if (!bus) return tl::unexpected(bus.error());
  auto cameras = open_recording(config, rig, clock);
  if (!cameras) return tl::unexpected(cameras.error());

  auto appliance =
      Appliance::create(config, rig, *map, {std::move(*cameras), std::move(*bus), &clock});
  if (!appliance) return tl::unexpected(appliance.error());
  spdlog::info("map {} with {} elements, model {}", map->name, map->elements.size(),
               (*appliance)->localizer().model_name());

  Supervisor supervisor(**appliance);
  State state = State::kInit;
  run_threads(**appliance, nullptr, [&](Time now) {
    supervisor.step(now);
    const ApplianceView& view = supervisor.view();
    if (view.state != state) {
      spdlog::info("{} -> {} ({})", to_string(state), to_string(view.state), to_string(view.why));
      state = view.state;
    }
    return !stop();
  });
  supervisor.finish();
  const FrameCounts frames = (*appliance)->frame_counts();
  spdlog::info("stopped: {} frames captured, {} used, {} dropped", frames.captured, frames.used,
               frames.dropped());
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
