#include "evaluation/calib/folder_recording.h"

#include <algorithm>

#include "common/image_file.h"

namespace bevloc::evaluation {
namespace {

constexpr Duration kWidestSpread = std::chrono::milliseconds(50);

bool holds_recordings(const std::filesystem::path& folder) {
  std::error_code none;
  const std::filesystem::directory_iterator entries(folder, none);
  return std::any_of(begin(entries), end(entries),
                     [](const auto& entry) { return entry.path().extension() == ".mcap"; });
}

}  // namespace

Result<std::unique_ptr<FolderRecording>> FolderRecording::open(const std::filesystem::path& folder,
                                                               const Rig& rig, Duration interval) {
  if (holds_recordings(folder)) {
    return fail("{}: found recordings (.mcap), wanted a picture folder, as --save-pictures makes",
                folder.string());
  }
  auto reference = ReferenceTrajectory::read(folder / kReferenceFile);
  if (!reference) return tl::unexpected(reference.error());
  const auto recorded = drivers::load_recordings(folder);
  if (!recorded) return tl::unexpected(recorded.error());
  Frames frames;
  std::vector<std::filesystem::path> files{folder / kReferenceFile};
  for (int camera = 0; camera < kCameraCount; ++camera) {
    files.push_back(folder / kCameraNames[camera] / drivers::kFrameIndex);
    for (const drivers::RecordedFrame& frame : (*recorded)[camera]) {
      frames.push_back({camera, frame});
      files.push_back(frame.file);
    }
  }
  if (frames.empty()) {
    return fail("{}: found no folder of a camera, wanted folders such as {}", folder.string(),
                kCameraNames[1]);
  }
  std::unique_ptr<FolderRecording> opened(
      new FolderRecording(rig, std::move(*reference), interval, std::move(frames)));
  opened->files_ = std::move(files);
  return opened;
}

FolderRecording::FolderRecording(const Rig& rig, ReferenceTrajectory reference, Duration interval,
                                 Frames frames)
    : rig_(rig), reference_(std::move(reference)) {
  std::ranges::stable_sort(frames, {}, [](const CameraFrame& of) { return of.frame.time; });
  std::optional<Time> start;
  CameraMask seen;  // in the frameset that began at `start`
  std::optional<Time> kept;
  for (CameraFrame& of : frames) {
    const auto camera = static_cast<size_t>(of.camera);
    cameras_.set(camera);
    const bool begins = !start || of.frame.time - *start > kWidestSpread || seen[camera];
    if (begins) seen.reset();
    seen.set(camera);
    if (begins) {
      start = of.frame.time;
      if (kept && *start - *kept < interval) continue;
      kept = start;
      framesets_.emplace_back();
    }
    if (kept == start) framesets_.back().push_back(std::move(of));
  }
}

Status FolderRecording::next(std::vector<RecordedPicture>& pictures) {
  pictures.clear();
  if (next_ == framesets_.size()) return {};
  RgbImage image;
  for (const auto& [camera, frame] : framesets_[next_++]) {
    const Intrinsics& lens = rig_.cameras[camera].intrinsics;
    if (image.width != lens.width_px || image.height != lens.height_px) {
      image = RgbImage(lens.width_px, lens.height_px);
    }
    if (Status read = read_camera_picture(frame.file.string(), image); !read) return read;
    pictures.push_back({camera, frame.time, grey_from(image.view())});
  }
  return {};
}

}  // namespace bevloc::evaluation
