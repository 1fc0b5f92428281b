#include "drivers/camera/replay/replay_camera.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "common/image_file.h"

namespace bevloc::drivers {
namespace {

CameraDescription description_of(const ReplayCameraConfig& config) {
  return {config.camera, config.width_px, config.height_px, config.buffers};
}

/// Parses one line of the index, without its comment. `place` is file and line for messages.
Result<RecordedFrame> parse_line(const std::string& line, const std::string& place,
                                 const std::filesystem::path& directory) {
  std::istringstream words(line);
  int64_t sequence = 0;
  int64_t time_ns = 0;
  std::string name;
  std::string surplus;
  if (!(words >> sequence >> time_ns >> name) || words >> surplus || sequence < 0) {
    return fail("{}: found \"{}\", wanted `sequence time_ns file`", place, line.substr(0, 80));
  }
  RecordedFrame frame{static_cast<uint64_t>(sequence), Time(Duration(time_ns)), directory / name};
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(frame.file, ignored)) {
    return fail("{}: found no file {}, wanted an image there", place, frame.file.string());
  }
  return frame;
}

}  // namespace

Result<std::vector<RecordedFrame>> load_recording(const std::filesystem::path& directory) {
  const std::string index = (directory / kFrameIndex).string();
  std::ifstream file(index);
  if (!file) {
    return fail("{}: found no readable file, wanted the index of a picture folder", index);
  }
  std::vector<RecordedFrame> recording;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string place = fmt::format("{}:{}", index, number);
    Result<RecordedFrame> frame = parse_line(line, place, directory);
    if (!frame) return tl::unexpected(frame.error());
    if (!recording.empty() &&
        (frame->sequence <= recording.back().sequence || frame->time <= recording.back().time)) {
      return fail("{}: found sequence {} and time {} after {} and {}, wanted both to increase",
                  place, frame->sequence, frame->time.time_since_epoch().count(),
                  recording.back().sequence, recording.back().time.time_since_epoch().count());
    }
    recording.push_back(std::move(*frame));
  }
  if (recording.empty()) return fail("{}: found no images, wanted at least one", index);
  return recording;
}

Result<RecordedFrames> load_recordings(const std::filesystem::path& directory) {
  RecordedFrames frames;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const std::filesystem::path folder = directory / kCameraNames[camera];
    if (!std::filesystem::is_directory(folder)) continue;
    auto recording = load_recording(folder);
    if (!recording) return tl::unexpected(recording.error());
    frames[camera] = std::move(*recording);
  }
  return frames;
}

ReplayCamera::ReplayCamera(const ReplayCameraConfig& config, Clock& clock)
    : PacedCamera(description_of(config), config.exposure, clock), config_(config) {}

Status ReplayCamera::open(Time now) {
  Result<std::vector<RecordedFrame>> recording = load_recording(config_.directory);
  if (!recording) return tl::unexpected(recording.error());
  recording_ = std::move(*recording);
  const auto is_over = [&](const RecordedFrame& frame) { return frame.time + config_.shift < now; };
  first_ = std::partition_point(recording_.begin(), recording_.end(), is_over) - recording_.begin();
  next_ = first_;
  if (recording_.size() > 1) {
    const Duration length = recording_.back().time - recording_.front().time;
    set_max_lateness(length / static_cast<int64_t>(recording_.size() - 1));
  }
  return {};
}

std::optional<Delivery> ReplayCamera::next_delivery() {
  if (next_ == recording_.size()) return std::nullopt;
  const RecordedFrame& frame = recording_[next_++];
  const Time start = frame.time + config_.shift;
  return Delivery{frame.sequence - recording_[first_].sequence, start, start,
                  start + config_.readout};
}

Status ReplayCamera::draw(const Delivery& /*delivery*/, RgbImage& image) {
  return read_image(recording_[next_ - 1].file.string(), image);
}

}  // namespace bevloc::drivers
