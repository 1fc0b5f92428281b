#include "evaluation/recording/replay_inputs.h"

#include <algorithm>
#include <charconv>

#include "firmware/recording/topics.h"

namespace bevloc::evaluation {
namespace {

/// The log time of the first bus frame, fix or image of the run. The head of the file does not
/// count.
uint64_t first_input_ns(const Recording& recording) {
  uint64_t first = recording.end_ns();
  const auto look_at = [&](std::string_view topic) {
    const auto& places = recording.messages(topic);
    if (!places.empty()) first = std::min(first, places.front().log_time_ns);
  };
  look_at(firmware::kBusInTopic);
  look_at(firmware::kBusOutTopic);
  look_at(firmware::kGnssTopic);
  for (int camera = 0; camera < kCameraCount; ++camera) look_at(firmware::image_topic(camera));
  return first;
}

/// The appliance would refuse each image whose size is not that of the rig.
Status check_image_sizes(Recording& recording, const Rig& rig) {
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const auto& places = recording.messages(firmware::calibration_topic(camera));
    if (places.empty()) continue;
    const auto recorded = recording.read<foxglove::CameraCalibration>(places.front());
    if (!recorded) return tl::unexpected(recorded.error());
    const Intrinsics& lens = rig.cameras[camera].intrinsics;
    if (static_cast<int>(recorded->width()) == lens.width_px &&
        static_cast<int>(recorded->height()) == lens.height_px) {
      continue;
    }
    return fail("{}: found images of {}x{} of the camera {}, wanted {}x{} as in the rig",
                recording.name(), recorded->width(), recorded->height(), kCameraNames[camera],
                lens.width_px, lens.height_px);
  }
  return {};
}

/// The recorded positions of gpsd, in the order of time.
Result<std::vector<firmware::RecordedFix>> recorded_fixes(Recording& recording) {
  std::vector<firmware::RecordedFix> fixes;
  for (const MessagePlace& place : recording.messages(firmware::kGnssTopic)) {
    const auto message = recording.read<foxglove::LocationFix>(place);
    if (!message) return tl::unexpected(message.error());
    const auto fix = firmware::fix_of(*message, recording.clock_time(place.log_time_ns));
    if (!fix) return fail("{}: {}", firmware::kGnssTopic, fix.error().message);
    fixes.push_back(*fix);
  }
  return fixes;
}

}  // namespace

Result<ReplayInputs> inputs_of(Recording& recording, const Rig& rig) {
  if (Status same = check_image_sizes(recording, rig); !same) return tl::unexpected(same.error());
  auto frames = played_frames(recording, firmware::kBusInTopic);
  if (!frames) return tl::unexpected(frames.error());
  auto fixes = recorded_fixes(recording);
  if (!fixes) return tl::unexpected(fixes.error());
  const std::string text = recording.value(firmware::kStartKey);
  int64_t start_ns = 0;
  std::from_chars(text.data(), text.data() + text.size(), start_ns);
  // A later file of a ring begins in the middle of the run: at one of its bus cycles.
  constexpr Duration kCycle = std::chrono::milliseconds(10);
  const Time start{Duration(start_ns)};
  const Time first = recording.clock_time(first_input_ns(recording));
  ReplayInputs inputs;
  inputs.begin = first < start ? first : start + (first - start) / kCycle * kCycle;
  inputs.end = recording.clock_time(recording.end_ns());
  inputs.bus = std::move(*frames);
  inputs.fixes = std::move(*fixes);
  inputs.cameras = [&recording, &rig](drivers::Clock& clock) {
    std::vector<std::unique_ptr<drivers::Camera>> cameras;
    for (int camera = 0; camera < kCameraCount; ++camera) {
      const Intrinsics& lens = rig.cameras[camera].intrinsics;
      cameras.push_back(
          std::make_unique<PlayedCamera>(recording, camera, lens.width_px, lens.height_px, clock));
    }
    return cameras;
  };
  return inputs;
}

}  // namespace bevloc::evaluation
