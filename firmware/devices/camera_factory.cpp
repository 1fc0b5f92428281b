#include "firmware/devices/camera_factory.h"

#include <algorithm>

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "drivers/camera/replay/replay_camera.h"
#include "drivers/camera/v4l2/v4l2_camera.h"
#ifdef BEVLOC_HAS_LIBCAMERA
#include "drivers/camera/libcamera/camera_ids.h"
#include "drivers/camera/libcamera/libcamera_camera.h"
#endif

namespace bevloc::firmware {
namespace {

using Cameras = std::vector<std::unique_ptr<drivers::Camera>>;

/// The time from now to the first frame of a recording, for which every camera must be ready.
constexpr Duration kReplayLead = std::chrono::seconds(1);

Result<Cameras> open_recording(const CameraConfig& config, const Rig& rig, drivers::Clock& clock) {
  std::vector<drivers::ReplayCameraConfig> replays;
  Time first = Time::max();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    drivers::ReplayCameraConfig replay;
    replay.camera = camera;
    replay.directory = config.recording / kCameraNames[camera];
    replay.width_px = rig.cameras[camera].intrinsics.width_px;
    replay.height_px = rig.cameras[camera].intrinsics.height_px;
    replay.buffers = config.buffers;
    const auto frames = drivers::load_recording(replay.directory);
    if (!frames) return tl::unexpected(frames.error());
    if (!frames->empty()) first = std::min(first, frames->front().time);
    replays.push_back(replay);
  }
  Cameras cameras;
  const Duration shift = clock.now() + kReplayLead - first;
  for (drivers::ReplayCameraConfig& replay : replays) {
    replay.shift = shift;
    cameras.push_back(std::make_unique<drivers::ReplayCamera>(replay, clock));
  }
  return cameras;
}

Cameras make_v4l2(const CameraConfig& config, const Rig& rig, drivers::Clock& clock) {
  const auto memory = config.devices.memory == CameraMemory::kDmabuf
                          ? drivers::v4l2::MemoryAccess::kDmabuf
                          : drivers::v4l2::MemoryAccess::kMapped;
  Cameras cameras;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    cameras.push_back(std::make_unique<drivers::V4l2Camera>(
        drivers::V4l2CameraConfig{device_camera(config.devices, config.buffers, rig, camera),
                                  memory},
        clock));
  }
  return cameras;
}

Status check_v4l2(const CameraConfig& config) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto node = drivers::v4l2::find_video_node(config.devices.ids[camera]);
    if (!node) return fail("camera {}: {}", kCameraNames[camera], node.error().message);
    if (const auto device = drivers::v4l2::Device::open(*node); !device) {
      return fail("camera {}: {}", kCameraNames[camera], device.error().message);
    }
  }
  return {};
}

#ifdef BEVLOC_HAS_LIBCAMERA
Result<Cameras> make_libcamera(const CameraConfig& config, const Rig& rig, drivers::Clock& clock) {
  Cameras cameras;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    cameras.push_back(std::make_unique<drivers::LibcameraCamera>(
        device_camera(config.devices, config.buffers, rig, camera), clock));
  }
  return cameras;
}

Status check_libcamera(const CameraConfig& config) {
  const std::vector<std::string> ids = drivers::libcamera_ids();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const std::string& id = config.devices.ids[camera];
    if (std::ranges::find(ids, id) == ids.end()) {
      return fail("camera {}: {}", kCameraNames[camera],
                  drivers::libcam::no_camera_called(id, ids));
    }
  }
  return {};
}
#else
tl::unexpected<Error> without_libcamera() {
  return fail(
      "cameras.driver: found libcamera, which this bevlocd was built without, wanted v4l2 or "
      "replay");
}

Result<Cameras> make_libcamera(const CameraConfig&, const Rig&, drivers::Clock&) {
  return without_libcamera();
}

Status check_libcamera(const CameraConfig&) {
  return without_libcamera();
}
#endif

/// Starts all cameras, so that they run at the same time, because they share buses and memory. Then
/// stops them.
Status start_and_stop(const CameraConfig& config, const Rig& rig) {
  drivers::MonotonicClock clock;
  auto cameras = make_cameras(config, rig, clock);
  if (!cameras) return tl::unexpected(cameras.error());
  Status result;
  std::vector<drivers::CameraDescription> started;
  for (const auto& camera : *cameras) {
    if (result) result = camera->start();
    if (result) started.push_back(camera->description());
  }
  const std::string warning = readout_warning(started);
  if (!warning.empty()) spdlog::warn("{}", warning);
  for (const auto& camera : *cameras) camera->stop();
  return result;
}

Status check_recordings(const CameraConfig& config) {
  for (const std::string_view camera : kCameraNames) {
    const auto recording = drivers::load_recording(config.recording / camera);
    if (!recording) return tl::unexpected(recording.error());
  }
  return {};
}

}  // namespace

Result<Cameras> make_cameras(const CameraConfig& config, const Rig& rig, drivers::Clock& clock) {
  switch (config.driver) {
    case CameraDriver::kV4l2:
      return make_v4l2(config, rig, clock);
    case CameraDriver::kLibcamera:
      return make_libcamera(config, rig, clock);
    case CameraDriver::kReplay:
      return open_recording(config, rig, clock);
    case CameraDriver::kMock:
      break;
  }
  return fail("cameras.driver: found mock, wanted v4l2, libcamera or replay");
}

std::string readout_warning(std::span<const drivers::CameraDescription> cameras) {
  std::vector<std::string_view> names;
  for (const drivers::CameraDescription& camera : cameras) {
    if (camera.ignores_readout) names.push_back(kCameraNames[camera.camera]);
  }
  if (names.empty()) return {};
  return fmt::format(
      "cameras.readout_ms: found a value that is not used for {}, because their driver says that "
      "it stamps the start of exposure; remove the key, and see docs/drivers.md for uvcvideo",
      fmt::join(names, ", "));
}

Status check_cameras(const CameraConfig& config, const Rig& rig) {
  switch (config.driver) {
    case CameraDriver::kV4l2:
      if (Status found = check_v4l2(config); !found) return found;
      return start_and_stop(config, rig);
    case CameraDriver::kLibcamera:
      if (Status found = check_libcamera(config); !found) return found;
      return start_and_stop(config, rig);
    case CameraDriver::kReplay:
      return check_recordings(config);
    case CameraDriver::kMock:
      break;
  }
  return {};
}

}  // namespace bevloc::firmware
