#include "evaluation/recording/candump_inputs.h"

#include <algorithm>
#include <fstream>
#include <set>

#include <fmt/ranges.h>

#include "can/bus/candump.h"
#include "common/cameras.h"
#include "drivers/camera/replay/replay_camera.h"
#include "firmware/devices/can_bus.h"

namespace bevloc::evaluation {
namespace {

namespace fs = std::filesystem;

/// The line of an entry in a log. A log can have empty lines, which are no entries.
std::string place_of_entry(const fs::path& log, size_t entry) {
  std::ifstream lines(log);
  std::string line;
  int number = 0;
  for (size_t entries = 0; entries <= entry && std::getline(lines, line); ++number) {
    if (line != "" && line != "\r") ++entries;
  }
  return fmt::format("{}:{}", log.string(), number);
}

/// Refuses a log whose clock jumps, for example from 1970 to today, because its replay would take
/// as long as the jump. Lines of several interfaces may be a little out of order.
Status check_times(const std::vector<can::CandumpEntry>& entries, const fs::path& log) {
  constexpr Duration kLongestGap = std::chrono::seconds(60);
  constexpr Duration kFarthestBack = std::chrono::seconds(1);
  for (size_t i = 1, newest = 0; i < entries.size(); ++i) {
    const Duration step = entries[i].time - entries[newest].time;
    if (step > kLongestGap) {
      return fail(
          "{}: found a time {:.1f} s after the line before, wanted at most {:g} s; the clock was "
          "set or the log was paused, so cut the log there and replay one part",
          place_of_entry(log, i), to_seconds(step), to_seconds(kLongestGap));
    }
    if (step < -kFarthestBack) {
      return fail(
          "{}: found a time {:.1f} s before that of an earlier line, wanted at most {:g} s; the "
          "clock was set back or logs were joined, so cut the log there and replay one part",
          place_of_entry(log, i), to_seconds(-step), to_seconds(kFarthestBack));
    }
    if (step > Duration::zero()) newest = i;
  }
  return {};
}

/// The interface of the vehicle's bus in a log: the configured one if the log has several. Fails if
/// the log has several others.
Result<std::string> interface_of(const std::vector<can::CandumpEntry>& entries,
                                 const std::string& configured, const fs::path& log) {
  std::set<std::string> interfaces;
  for (const can::CandumpEntry& entry : entries) interfaces.insert(entry.interface);
  if (interfaces.size() == 1) return *interfaces.begin();
  if (interfaces.contains(configured)) return configured;
  return fail("{}: found frames of {}, wanted those of can.interface ({}) or of one interface",
              log.string(), fmt::join(interfaces, ", "), configured);
}

}  // namespace

Result<ReplayInputs> inputs_of_candump(const fs::path& log, const fs::path& images,
                                       const ReplaySetup& setup) {
  const auto entries = can::read_candump_file(log.string());
  if (!entries) return tl::unexpected(entries.error());
  if (Status status = check_times(*entries, log); !status) return tl::unexpected(status.error());
  const auto interface = interface_of(*entries, setup.config.can.interface, log);
  if (!interface) return tl::unexpected(interface.error());
  const auto accepted = firmware::appliance_options(setup.config.can).accepted_ids;
  ReplayInputs inputs;
  for (const can::CandumpEntry& entry : *entries) {
    const bool wanted = entry.kind == can::CandumpKind::kData && entry.interface == *interface &&
                        std::ranges::find(accepted, entry.frame.id) != accepted.end();
    if (wanted) inputs.bus.push_back({Time(entry.time), {entry.frame, Time(entry.time)}});
  }
  if (inputs.bus.empty()) {
    return fail(
        "{}: found none of the vehicle's messages, wanted odometry and GNSS with the "
        "identifiers of the configuration",
        log.string());
  }
  std::ranges::stable_sort(inputs.bus, {}, &PlayedFrame::delivered);
  inputs.begin = inputs.bus.front().delivered;
  inputs.end = inputs.bus.back().delivered;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto frames = drivers::load_recording(images / kCameraNames[camera]);
    if (!frames) return tl::unexpected(frames.error());
    if (frames->front().time > inputs.end || frames->back().time < inputs.begin) {
      return fail(
          "{}: found pictures from {:.1f} s to {:.1f} s, wanted times of the log, which "
          "goes from {:.1f} s to {:.1f} s",
          (images / kCameraNames[camera] / drivers::kFrameIndex).string(),
          to_seconds(frames->front().time.time_since_epoch()),
          to_seconds(frames->back().time.time_since_epoch()),
          to_seconds(inputs.begin.time_since_epoch()), to_seconds(inputs.end.time_since_epoch()));
    }
    inputs.begin = std::min(inputs.begin, frames->front().time);
  }
  inputs.cameras = [images, &setup](drivers::Clock& clock) {
    std::vector<std::unique_ptr<drivers::Camera>> cameras;
    for (int camera = 0; camera < kCameraCount; ++camera) {
      drivers::ReplayCameraConfig played;
      played.camera = camera;
      played.directory = images / kCameraNames[camera];
      played.width_px = setup.rig.cameras[camera].intrinsics.width_px;
      played.height_px = setup.rig.cameras[camera].intrinsics.height_px;
      played.buffers = setup.config.cameras.buffers;
      cameras.push_back(std::make_unique<drivers::ReplayCamera>(played, clock));
    }
    return cameras;
  };
  return inputs;
}

}  // namespace bevloc::evaluation
